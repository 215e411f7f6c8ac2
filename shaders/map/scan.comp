#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Exclusive prefix sum of the counts of all workgroups, in place, by one workgroup; the total goes into the map's state.
#include "shaders/shared/map.h"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) buffer Counts { uint counts[]; };
layout(scalar, binding = 1) buffer State { MapState state; };
layout(scalar, binding = 2) readonly buffer Visible { uint groups[3]; uint blocks[]; };
layout(scalar, push_constant) uniform Push { ScanParams p; };
shared uint sums[256];

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint group_count = p.ends_frame != 0u ? groups[0] : p.group_count;
  uint share = (group_count + 255u) / 256u;
  uint first = min(lane * share, group_count), last = min(first + share, group_count);
  uint sum = 0u;
  for (uint i = first; i < last; ++i) sum += counts[i];
  sums[lane] = sum;
  barrier();
  uint offset = 0u;
  for (uint i = 0u; i < lane; ++i) offset += sums[i];
  for (uint i = first; i < last; ++i) {
    uint count = counts[i];
    counts[i] = offset;
    offset += count;
  }
  if (lane != 255u) return;
  if (p.ends_frame != 0u) {
    state.slot_count += state.new_count > state.free_count ? state.new_count - state.free_count : 0u;
    state.alive_count += state.new_count - state.freed_count;
    state.free_count = offset;
    state.new_count = 0u;
    state.freed_count = 0u;
  } else {
    state.new_count = offset;
  }
}
