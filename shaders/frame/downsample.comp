#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Computes one pyramid level of surface maps: the mean of 2x2 pixels, or no surface where two of
// them are missing or one is on another surface. Where one is missing, the depth is the mean of the
// diagonal that is complete: its centre is that of the four, so slanted surfaces are not displaced.
// The coarse camera has cx' = (cx - 0.5) / 2.
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
  float depth_m[4];
  float low = 1e9, high = 0.0, count = 0.0, weight_sum = 0.0;
  float grey_low = 1e9, grey_sum = 0.0;
  vec3 normal_sum = vec3(0.0);
  vec2 curvature_sum = vec2(0.0);
  for (int i = 0; i < 4; ++i) {
    float g = float_at(fine_intensity, fine[i]);
    grey_sum += g;
    grey_low = min(grey_low, g);
    SurfacePoint point = point_at(fine_points, fine[i]);
    depth_m[i] = point.depth_m;
    if (point.depth_m <= 0.0) continue;
    low = min(low, point.depth_m);
    high = max(high, point.depth_m);
    normal_sum += unpack_normal(point.normal);
    weight_sum += point.weight;
    curvature_sum += unpackHalf2x16(point.curvatures);
    count += 1.0;
  }
  uint index = pixel.y * p.width + pixel.x;
  float beyond_m = max(low - 0.4, 0.0);
  bool valid = count >= 3.0 &&
               high - low < p.depth_gate_m + p.gate_growth_per_m * beyond_m * beyond_m;
  bool falling = min(depth_m[0], depth_m[3]) > 0.0, rising = min(depth_m[1], depth_m[2]) > 0.0;
  float depth_sum = (falling ? depth_m[0] + depth_m[3] : 0.0) +
                    (rising ? depth_m[1] + depth_m[2] : 0.0);
  points[index] = valid ? SurfacePoint(depth_sum / (falling && rising ? 4.0 : 2.0),
                                       pack_normal(normalize(normal_sum)),
                                       packHalf2x16(curvature_sum / count), weight_sum / count)
                        : kNoPoint;
  // Negative: no colour (a hole in the prediction).
  intensity[index] = grey_low >= 0.0 ? 0.25 * grey_sum : -1.0;
}
