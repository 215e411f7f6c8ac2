#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// How many slots of each listed block are free for use.
#include "shaders/shared/map.h"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) readonly buffer Positions { vec4 position_confidence[]; };
layout(scalar, binding = 1) writeonly buffer Groups { uint free_by_group[]; };
layout(scalar, binding = 2) readonly buffer State { MapState state; };
layout(scalar, binding = 3) readonly buffer Visible { uint groups[3]; uint turn_groups[3]; uint blocks[]; };
layout(scalar, binding = 4) readonly buffer Bounds { BlockBounds bounds[]; };
layout(scalar, push_constant) uniform Push { FreeListParams p; };
shared uint is_free[kBlock];

void main() {
  uint lane = gl_LocalInvocationID.x, entry = blocks[gl_WorkGroupID.x], slot = block_of(entry) * kBlock + lane;
  is_free[lane] = slot < state.slot_count + state.fresh_count && position_confidence[slot].w <= 0.0 ? 1u : 0u;
  barrier();
  if (lane != 0u) return;
  uint count = 0u;
  for (uint i = 0u; i < kBlock; ++i) count += is_free[i];
  free_by_group[gl_WorkGroupID.x] = count == kBlock || has_room(entry, bounds[block_of(entry)], p.submap) ? count : 0u;
}
