#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Sensor units to metres, and the bilateral filter (paper section 3.2). It works on inverse depth, which is linear over the image of a plane: a
// mean over the window leaves planes where they are, however tilted, and a triangulating sensor's noise is the same on both sides. Its width
// over depth follows the sensor's noise at that depth instead of being fixed: 30 mm everywhere, as in the authors' program, rounds off
// what a Kinect still resolves at 1 m.
// Two outputs, by sampled pixel: the measured depth, and the filtered one; 0 where nothing was measured inside the range. The filter looks at
// all pixels.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, units);  // two pixels a word
layout(scalar, binding = 1) writeonly buffer Raw { float raw_m[]; };
layout(scalar, binding = 2) writeonly buffer Filtered { float filtered_m[]; };
PARAMETERS(BilateralParams, p);

layout(constant_id = 0) const int kRadius = 6;  // of the window
layout(constant_id = 1) const int kStep = 1;    // as in p.sampling
const int kTile = 16 * kStep + 2 * kRadius;
shared float tile[kTile * kTile];  // 1/m, 0 where nothing was measured

float measured_depth_m(ivec2 pixel) {
  if (!inside(p.camera, pixel)) return 0.0;
  uint index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  uint word = uint_at(units, index >> 1);
  float depth_m = float((index & 1u) == 0u ? word & 0xffffu : word >> 16) * p.metres_per_unit;
  return depth_m >= p.depth_min_m && depth_m <= p.depth_max_m ? depth_m : 0.0;
}

float inverse_depth_per_m(ivec2 pixel) {
  float depth_m = measured_depth_m(pixel);
  return depth_m > 0.0 ? 1.0 / depth_m : 0.0;
}

void main() {
  ivec2 corner = pixel_of_sample(p.sampling, gl_WorkGroupID.xy * 16u) - kRadius;
  for (uint i = gl_LocalInvocationIndex; i < kTile * kTile; i += 256u)
    tile[i] = inverse_depth_per_m(corner + ivec2(i % kTile, i / kTile));
  barrier();

  uvec2 sampled = gl_GlobalInvocationID.xy, size = sampled_size(p.camera, p.sampling);
  if (sampled.x >= size.x || sampled.y >= size.y) return;
  ivec2 local = ivec2(gl_LocalInvocationID.xy) * kStep + kRadius;
  float centre_m = measured_depth_m(pixel_of_sample(p.sampling, sampled));
  float centre_per_m = tile[local.y * kTile + local.x];
  uint index = sampled.y * size.x + sampled.x;
  raw_m[index] = centre_m;
  filtered_m[index] = 0.0;
  if (centre_m <= 0.0) return;

  float beyond = max(centre_m - 0.4, 0.0);
  float sigma_m = p.noise_sigmas * (p.noise_floor_m + p.noise_growth_per_m * beyond * beyond);
  float sigma_per_m = sigma_m * centre_per_m * centre_per_m;
  float inverse_two_sigma2 = 0.5 / (sigma_per_m * sigma_per_m);
  float sum = 0.0, weights = 0.0;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      float per_m = tile[(local.y + dy) * kTile + local.x + dx];
      float difference = per_m - centre_per_m;
      float w = exp(-float(dx * dx + dy * dy) * p.inverse_two_sigma_space2 - difference * difference * inverse_two_sigma2);
      w = per_m > 0.0 ? w : 0.0;
      sum += w * per_m;
      weights += w;
    }
  }
  filtered_m[index] = weights / sum;
}
