#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Prefix sum of the counts of all workgroups, in place and zone by zone (stable), by one workgroup;
// the totals of zones go to the map's state. The counted workgroups are tiles of pixels with new
// surfels, or listed blocks with free slots.
#include "shaders/shared/map.h"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 128) in;
layout(scalar, binding = 0) buffer Counts { uint counts[]; };
layout(scalar, binding = 1) buffer State { MapState state; };
layout(scalar, binding = 2) readonly buffer Visible { VisibleHead head; uint visible_blocks[]; };
PARAMETERS(ScanParams, p);
const uint kZones = HERMITE_ZONES, kLanes = 128u;
shared uint sums[kZones * kLanes];  // by zone and lane
shared uint totals[kZones];

uint zone_of_group(uint group) {
  return p.tile_count > 0u ? zone_of_tile(p.camera, group) : zone_of_block(visible_blocks[group]);
}

void begin_appending() {
  uint begin = 0u, fresh = 0u;
  for (uint zone = 0u; zone < kZones; ++zone) {
    state.zones[zone].new_begin = begin;
    state.zones[zone].fresh_begin = fresh;
    begin += totals[zone];
    fresh += totals[zone] - min(totals[zone], state.zones[zone].free_count);
  }
  state.new_count = begin;
  state.new_groups = uint[3]((begin + 255u) / 256u, 1u, 1u);
  state.fresh_count = fresh;
}

void end_frame() {
  uint begin = 0u;
  for (uint zone = 0u; zone < kZones; ++zone) {
    state.zones[zone].free_begin = begin;
    state.zones[zone].free_count = totals[zone];
    begin += totals[zone];
  }
  state.free_count = begin;
  state.slot_count += state.fresh_count;
  state.alive_count += state.new_count - state.freed_count;
  state.new_count = 0u;
  state.fresh_count = 0u;
  state.freed_count = 0u;
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint group_count = p.tile_count > 0u ? p.tile_count : head.groups[0];
  uint share = (group_count + kLanes - 1u) / kLanes;
  uint first = min(lane * share, group_count), last = min(first + share, group_count);
  for (uint zone = 0u; zone < kZones; ++zone) sums[zone * kLanes + lane] = 0u;
  for (uint group = first; group < last; ++group)
    sums[zone_of_group(group) * kLanes + lane] += counts[group];
  barrier();
  if (lane < kZones) {
    uint sum = 0u;
    for (uint i = lane * kLanes; i < (lane + 1u) * kLanes; ++i) {
      uint count = sums[i];
      sums[i] = sum;
      sum += count;
    }
    totals[lane] = sum;
  }
  barrier();
  for (uint group = first; group < last; ++group) {
    uint zone = zone_of_group(group), count = counts[group], begin = sums[zone * kLanes + lane];
    sums[zone * kLanes + lane] = begin + count;
    for (uint i = 0u; i < zone; ++i) begin += totals[i];
    counts[group] = begin;
  }
  if (lane != 0u) return;
  if (p.tile_count > 0u)
    begin_appending();
  else
    end_frame();
}
