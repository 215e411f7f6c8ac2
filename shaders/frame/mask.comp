#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Sets the weight of pixels of one level to zero if their coarse pixel is masked; odometry and
// fusion ignore them.
#include "shaders/shared/frame.h"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, mask);
layout(scalar, binding = 1) buffer Points { SurfacePoint points[]; };
PARAMETERS(MaskParams, p);

void main() {
  uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= p.width || pixel.y >= p.height) return;
  uvec2 cell = min(pixel >> p.shift, uvec2(p.mask_width, p.mask_height) - 1u);
  if (uint_at(mask, cell.y * p.mask_width + cell.x) != 0u)
    points[pixel.y * p.width + pixel.x].weight = 0.0;
}
