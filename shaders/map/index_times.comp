#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Collects, once per pixel of the index map, the data of its stable surfel that cleaning reads from
// all surfels around it.
#include "shaders/shared/map.h"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 256) in;
TEXELS(0, nearest);  // NearestSurfel
TEXELS(1, times);
// Slot, depth bits, frames of creation and last observation.
layout(scalar, binding = 2) writeonly buffer Seen { uvec4 seen[]; };
PARAMETERS(uint, pixel_count);

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= pixel_count) return;
  uvec2 shown = uvec2_at(nearest, i);
  seen[i] = uvec4(shown, shown.x != HERMITE_NONE ? uvec2_at(times, shown.x) : uvec2(0u));
}
