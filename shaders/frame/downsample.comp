#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Computes one pyramid level of surface maps: the mean of 2x2 pixels, or no surface where one of
// them is missing or on another surface. The centre of a coarse pixel is the centre of the four, so
// the coarse camera has cx' = (cx - 0.5) / 2.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surface_point.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, fine_points);
TEXELS(1, fine_intensity);
layout(scalar, binding = 2) writeonly buffer Points { SurfacePoint points[]; };
layout(scalar, binding = 3) writeonly buffer Intensity { float intensity[]; };
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
    SurfacePoint point = point_at(fine_points, fine[i]);
    float z = point.depth_m;
    float g = float_at(fine_intensity, fine[i]);
    low = min(low, z);
    high = max(high, z);
    depth_sum += z;
    normal_sum += unpack_normal(point.normal);
    weight_sum += point.weight;
    curvature_sum += unpackHalf2x16(point.curvatures);
    grey_sum += g;
    grey_low = min(grey_low, g);
  }
  uint index = pixel.y * p.width + pixel.x;
  bool valid = low > 0.0 && high - low < p.depth_gate_m;
  points[index] = valid ? SurfacePoint(0.25 * depth_sum, pack_normal(normalize(normal_sum)),
                                       packHalf2x16(0.25 * curvature_sum), 0.25 * weight_sum)
                        : kNoPoint;
  // Negative: no colour (a hole in the prediction).
  intensity[index] = grey_low >= 0.0 ? 0.25 * grey_sum : -1.0;
}
