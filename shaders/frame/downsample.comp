#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// One pyramid level of surface maps: the mean of 2x2 pixels, nothing where one of them is missing or lies on another surface.
// The centre of the coarse pixel is the centre of the four, so the coarse camera has cx' = (cx - 0.5) / 2.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, fine_depth_m);
TEXELS(1, fine_normals);
TEXELS(2, fine_curvatures);
TEXELS(3, fine_weight);
TEXELS(4, fine_intensity);
layout(scalar, binding = 5) writeonly buffer Depth { float depth_m[]; };
layout(scalar, binding = 6) writeonly buffer Normals { uint normals[]; };
layout(scalar, binding = 7) writeonly buffer Curvatures { uint curvatures[]; };
layout(scalar, binding = 8) writeonly buffer Weight { float weight[]; };
layout(scalar, binding = 9) writeonly buffer Intensity { float intensity[]; };
PARAMETERS(DownsampleParams, p);

void main() {
  uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= p.width || pixel.y >= p.height) return;
  uint fine_width = p.fine_width;
  uint first = 2u * pixel.y * fine_width + 2u * pixel.x;
  uint fine[4] = uint[4](first, first + 1u, first + fine_width, first + fine_width + 1u);
  float depth_sum = 0.0, low = 1e9, high = 0.0, grey_sum = 0.0;
  float grey_low = 1e9;
  vec3 normal_sum = vec3(0.0);
  float weight_sum = 0.0;
  vec2 curvature_sum = vec2(0.0);
  for (int i = 0; i < 4; ++i) {
    float z = float_at(fine_depth_m, fine[i]);
    float g = float_at(fine_intensity, fine[i]);
    low = min(low, z);
    high = max(high, z);
    depth_sum += z;
    normal_sum += unpack_normal(uint_at(fine_normals, fine[i]));
    weight_sum += float_at(fine_weight, fine[i]);
    curvature_sum += unpackHalf2x16(uint_at(fine_curvatures, fine[i]));
    grey_sum += g;
    grey_low = min(grey_low, g);
  }
  uint index = pixel.y * p.width + pixel.x;
  bool valid = low > 0.0 && high - low < p.depth_gate_m;
  depth_m[index] = valid ? 0.25 * depth_sum : 0.0;
  normals[index] = valid ? pack_normal(normalize(normal_sum)) : kNoNormal;
  curvatures[index] = valid ? packHalf2x16(0.25 * curvature_sum) : 0u;
  weight[index] = valid ? 0.25 * weight_sum : 0.0;
  intensity[index] = grey_low >= 0.0 ? 0.25 * grey_sum : -1.0;  // negative: no colour here (a hole of the prediction)
}
