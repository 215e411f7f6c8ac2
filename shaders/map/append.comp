#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Appends new surfels in pixel order to the free slots of their zone, then to slots at the end, so
// that the same measurement gets the same slot in every run.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/fuse_bindings.glsl"
layout(local_size_x = 256) in;
TEXELS(10, free_slots);
layout(scalar, binding = 11) buffer Bounds { BlockBounds bounds[]; };
layout(scalar, binding = 12) writeonly buffer Changed { uint changed_frame[]; };
#include "shaders/lib/new_in_tile.glsl"

void main() {
  uint i = pixel_index();
  bool fresh = i != HERMITE_NONE && candidates[i] == kNew;
  share_new(fresh);
  if (!fresh) return;
  uint rank = new_by_group[gl_WorkGroupID.x] + new_before(gl_LocalInvocationID.x);
  ZoneSlots zone = state.zones[zone_of_tile(p.camera, gl_WorkGroupID.x)];
  rank -= zone.new_begin;
  uint slot = rank < zone.free_count ? uint_at(free_slots, zone.free_begin + rank)
                                     : state.slot_count + zone.fresh_begin + rank - zone.free_count;
  if (slot >= p.slot_capacity) return;
  Measurement m = measure(i);
  Transform t = transform_at(camera_from_submap, p.submap);
  vec3 position = transform_back(t, m.position);
  for (uint direction = 0u; direction < 8u; ++direction)
    atomicMax(bounds[slot / kBlock].reach[direction], ordered(reach(direction, vec4(position, float(p.submap)))));
  position_confidence[slot] = vec4(position, m.confidence);
  attributes[slot] = SurfelAttributes(pack_unit(rotate_back(t, m.normal)), pack_radius_submap(m.radius_m, p.submap),
                                      pack_color(m.color, vec3(0.5)), packHalf2x16(m.curvatures));
  times[slot] = uvec2(p.frame_number);
  changed_frame[slot / kBlock] = p.frame_number;
}
