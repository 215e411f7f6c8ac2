#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Writes the free slots of the listed blocks, zone by zone. Those that cleaning has just freed (confidence -1) get this frame's number.
#include "shaders/shared/map.h"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) buffer Positions { vec4 position_confidence[]; };
layout(scalar, binding = 1) readonly buffer Groups { uint free_by_group[]; };
layout(scalar, binding = 2) readonly buffer State { MapState state; };
layout(scalar, binding = 3) writeonly buffer FreeList { uint free_slots[]; };
layout(scalar, binding = 4) writeonly buffer Times { uvec2 times[]; };
layout(scalar, binding = 5) readonly buffer Visible { uint groups[3]; uint turn_groups[3]; uint blocks[]; };
layout(scalar, binding = 6) readonly buffer Bounds { BlockBounds bounds[]; };
layout(scalar, binding = 7) writeonly buffer Changed { uint changed_frame[]; };
layout(scalar, push_constant) uniform Push { FreeListParams p; };
const uint kRow = 16u;
shared uint is_free[kBlock];
shared uint free_in_row[kBlock / kRow];

// Free slots before this lane, by rows of lanes: a walk along all of them costs more than all the rest where most are free.
uint free_before(uint lane) {
  uint count = 0u;
  for (uint row = 0u; row < lane / kRow; ++row) count += free_in_row[row];
  for (uint i = lane / kRow * kRow; i < lane; ++i) count += is_free[i];
  return count;
}

bool all_free() {
  uint count = 0u;
  for (uint row = 0u; row < kBlock / kRow; ++row) count += free_in_row[row];
  return count == kBlock;
}

void main() {
  uint group = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x, slot = block_of(blocks[group]) * kBlock + lane;
  bool dead = slot < state.slot_count && position_confidence[slot].w <= 0.0;
  is_free[lane] = dead ? 1u : 0u;
  barrier();
  if (lane < kBlock / kRow) {
    uint count = 0u;
    for (uint i = 0u; i < kRow; ++i) count += is_free[lane * kRow + i];
    free_in_row[lane] = count;
  }
  barrier();
  if (!dead) return;
  if (position_confidence[slot].w < 0.0) {
    position_confidence[slot].w = 0.0;
    times[slot].y = p.frame_number;
    changed_frame[slot / kBlock] = p.frame_number;
  }
  if (!has_room(blocks[group], bounds[block_of(blocks[group])], p.submap) && !all_free()) return;  // as map/count_free has it
  free_slots[free_by_group[group] + free_before(lane)] = slot;
}
