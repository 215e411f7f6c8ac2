#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The bilateral filter (paper section 3.2), on inverse depth, which is linear over the image of a
// plane: a mean over the window keeps planes unchanged, however tilted, and a triangulating
// sensor's noise is symmetric. The width in depth follows the sensor's noise at that depth; a fixed
// width of 30 mm, as in the authors' program, would smooth away what a Kinect still resolves at 1
// m. The outputs, per sampled pixel, are the measured and the filtered depth; 0 where nothing was
// measured within the range. The filter uses all pixels. Each invocation computes four neighbouring
// samples (the components of a vec4), so that shared parts of their windows are read once.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 8, local_size_y = 16) in;
TEXELS(0, inverse_depth_per_m);  // four pixels per texel, with a margin
layout(scalar, binding = 1) writeonly buffer Raw { float raw_m[]; };
layout(scalar, binding = 2) writeonly buffer Filtered { float filtered_m[]; };
PARAMETERS(BilateralParams, p);

layout(constant_id = 0) const int kRadius = 6;  // of the window
layout(constant_id = 1) const int kStep = 1;    // as in p.sampling
// Number of texels that the window extends to the left of the first sample's.
const int kLeft = (kRadius + 3) / 4;
const int kTexels = kLeft + (3 * kStep + kRadius + 1) / 4 + 1;
// Columns of a row, for radii up to 8: from kLeft texels on, shifted by the sampling's offset.
float columns[24];

void read_row(int texel) {
  for (int i = 0; i < kTexels; ++i) {
    vec4 four = vec4_at(inverse_depth_per_m, uint(texel + i));
    columns[4 * i] = four.x;
    columns[4 * i + 1] = four.y;
    columns[4 * i + 2] = four.z;
    columns[4 * i + 3] = four.w;
  }
  if (kStep == 1) return;
  bool odd = p.sampling.x != 0u;
  for (int i = 0; i < 4 * kTexels - 1; ++i) columns[i] = odd ? columns[i + 1] : columns[i];
}

// Returns the pixels offset by dx from the four samples.
vec4 beside(int dx) {
  int first = 4 * kLeft + dx;
  return vec4(columns[first], columns[first + kStep], columns[first + 2 * kStep],
              columns[first + 3 * kStep]);
}

void main() {
  uvec2 sampled = gl_GlobalInvocationID.xy * uvec2(4u, 1u),
        size = sampled_size(p.camera, p.sampling);
  if (sampled.x >= size.x || sampled.y >= size.y) return;
  int y = int(p.sampling.step * sampled.y + p.sampling.y) + HERMITE_DEPTH_MARGIN;
  int texel = (y * HERMITE_DEPTH_STRIDE(int(p.camera.width)) + HERMITE_DEPTH_MARGIN +
               kStep * int(sampled.x)) / 4 - kLeft;
  int row = HERMITE_DEPTH_STRIDE(int(p.camera.width)) / 4;
  read_row(texel);
  vec4 centre_per_m = beside(0);
  vec4 centre_m = mix(vec4(0.0), 1.0 / centre_per_m, greaterThan(centre_per_m, vec4(0.0)));

  vec4 beyond = max(centre_m - 0.4, 0.0);
  vec4 sigma_m = p.noise_sigmas * (p.noise_floor_m + p.noise_growth_per_m * beyond * beyond);
  vec4 sigma_per_m = sigma_m * centre_per_m * centre_per_m;
  vec4 inverse_two_sigma2 = 0.5 / (sigma_per_m * sigma_per_m);
  vec4 sum = vec4(0.0), weights = vec4(0.0);
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    read_row(texel + dy * row);
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      vec4 per_m = beside(dx);
      vec4 difference = per_m - centre_per_m;
      vec4 w = exp(-float(dx * dx + dy * dy) * p.inverse_two_sigma_space2 -
                   difference * difference * inverse_two_sigma2);
      w = mix(vec4(0.0), w, greaterThan(per_m, vec4(0.0)));
      sum += w * per_m;
      weights += w;
    }
  }
  for (int i = 0; i < 4; ++i) {
    if (sampled.x + uint(i) >= size.x) continue;
    uint index = sampled.y * size.x + sampled.x + uint(i);
    raw_m[index] = centre_m[i];
    filtered_m[index] = centre_m[i] > 0.0 ? weights[i] / sum[i] : 0.0;
  }
}
