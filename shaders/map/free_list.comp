#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Writes the free slots of the listed blocks, zone by zone. Slots just freed by cleaning
// (confidence -1) get this frame's number. A lane processes a row of slots, as in map/count_free.
#include "shaders/shared/map.h"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 16) in;
layout(scalar, binding = 0) writeonly buffer Positions { vec4 position_confidence[]; };
layout(scalar, binding = 1) readonly buffer Groups { uint free_by_group[]; };
layout(scalar, binding = 2) readonly buffer State { MapState state; };
layout(scalar, binding = 3) writeonly buffer FreeList { uint free_slots[]; };
layout(scalar, binding = 4) writeonly buffer Times { uvec2 times[]; };
TEXELS(5, visible_blocks);
layout(scalar, binding = 6) readonly buffer Bounds { BlockBounds bounds[]; };
layout(scalar, binding = 7) writeonly buffer Changed { uint changed_frame[]; };
TEXELS(8, read_position_confidence);  // a surfel is written by its own thread only
PARAMETERS(FreeListParams, p);
const uint kRows = gl_WorkGroupSize.x, kRow = kBlock / kRows;
shared uint free_in_row[kRows];

void main() {
  uint group = gl_WorkGroupID.x, row = gl_LocalInvocationID.x;
  uint entry = listed_block(visible_blocks, group), block = block_of(entry),
       first = block * kBlock + row * kRow;
  uint end = min(first + kRow, state.slot_count);
  uint is_free = 0u, just_freed = 0u;  // bit i: the row's slot i
  for (uint slot = first; slot < end; ++slot) {
    float confidence = vec4_at(read_position_confidence, slot).w;
    is_free |= (confidence <= 0.0 ? 1u : 0u) << (slot - first);
    just_freed |= (confidence < 0.0 ? 1u : 0u) << (slot - first);
  }
  free_in_row[row] = bitCount(is_free);
  for (; just_freed != 0u; just_freed &= just_freed - 1u) {
    uint slot = first + findLSB(just_freed);
    position_confidence[slot].w = 0.0;
    times[slot].y = p.frame_number;
    changed_frame[block] = p.frame_number;
  }
  barrier();
  uint before = 0u, all = 0u;
  for (uint i = 0u; i < kRows; ++i) {
    before += i < row ? free_in_row[i] : 0u;
    all += free_in_row[i];
  }
  if (!has_room(entry, bounds[block], p.submap) && all != kBlock) return;  // as in map/count_free
  for (uint at = free_by_group[group] + before; is_free != 0u; is_free &= is_free - 1u)
    free_slots[at++] = first + findLSB(is_free);
}
