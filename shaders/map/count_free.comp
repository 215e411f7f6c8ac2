#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Counts the usable free slots of each listed block. A lane processes a row of slots, because one
// lane per slot would mostly wait.
#include "shaders/shared/map.h"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 16) in;
TEXELS(0, position_confidence);
layout(scalar, binding = 1) writeonly buffer Groups { uint free_by_group[]; };
layout(scalar, binding = 2) readonly buffer State { MapState state; };
TEXELS(3, visible_blocks);
layout(scalar, binding = 4) readonly buffer Bounds { BlockBounds bounds[]; };
PARAMETERS(FreeListParams, p);
const uint kRows = gl_WorkGroupSize.x, kRow = kBlock / kRows;
shared uint free_in_row[kRows];

void main() {
  uint row = gl_LocalInvocationID.x, entry = listed_block(visible_blocks, gl_WorkGroupID.x),
       first = block_of(entry) * kBlock + row * kRow;
  uint end = min(first + kRow, state.slot_count + state.fresh_count), free = 0u;
  for (uint slot = first; slot < end; ++slot)
    free += vec4_at(position_confidence, slot).w <= 0.0 ? 1u : 0u;
  free_in_row[row] = free;
  barrier();
  if (row != 0u) return;
  uint count = 0u;
  for (uint i = 0u; i < kRows; ++i) count += free_in_row[i];
  free_by_group[gl_WorkGroupID.x] =
      count == kBlock || has_room(entry, bounds[block_of(entry)], p.submap) ? count : 0u;
}
