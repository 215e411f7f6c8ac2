#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Appends the listed new surfels to the free slots of their zone, then to slots at the end.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/fuse_bindings.glsl"
layout(local_size_x = 256) in;
TEXELS(10, free_slots);
layout(scalar, binding = 11) buffer Bounds { BlockBounds bounds[]; };
layout(scalar, binding = 12) writeonly buffer Changed { uint changed_frame[]; };
TEXELS(13, new_pixels);

void main() {
  uint listed = gl_GlobalInvocationID.x;
  if (listed >= state.new_count) return;
  uint i = uint_at(new_pixels, listed);
  ZoneSlots zone = state.zones[zone_of_tile(p.camera, tile_of_pixel(p.camera, uvec2(pixel_of(i))))];
  uint rank = listed - zone.new_begin;
  uint slot = rank < zone.free_count ? uint_at(free_slots, zone.free_begin + rank)
                                     : state.slot_count + zone.fresh_begin + rank - zone.free_count;
  if (slot >= p.slot_capacity) return;
  Measurement m = measure(i);
  Transform t = transform_at(camera_from_submap, p.submap);
  vec3 position = transform_back(t, m.position);
  for (uint direction = 0u; direction < 8u; ++direction)
    atomicMax(bounds[slot / kBlock].reach[direction],
              ordered(reach(direction, vec4(position, float(p.submap)))));
  position_confidence[slot] = vec4(position, m.confidence);
  attributes[slot] = SurfelAttributes(pack_unit(rotate_back(t, m.normal)),
                                      pack_radius_submap(m.radius_m, p.submap),
                                      pack_color(m.color, vec3(0.5)), packHalf2x16(m.curvatures));
  times[slot] = uvec2(p.frame_number);
  changed_frame[slot / kBlock] = p.frame_number;
}
