#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Lists the blocks whose turn for cleaning it is, then the others that may be visible, each in
// ascending order, with one workgroup; also writes the sizes of the dispatches that follow. Blocks
// outside the view cost nothing.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) readonly buffer Bounds { BlockBounds bounds[]; };
layout(scalar, binding = 1) readonly buffer Submaps { Transform camera_from_submap[]; };
layout(scalar, binding = 2) readonly buffer State { MapState state; };
layout(scalar, binding = 3) writeonly buffer Visible { VisibleHead head; uint visible_blocks[]; };
PARAMETERS(VisibleParams, p);
shared uvec2 counts[256], total;  // whose turn it is, others

struct Box {
  vec3 centre;  // camera frame
  vec3 half_size;
  Transform t;
};

// Returns whether a part of the box is where dot(normal, point) + offset >= 0.
bool reaches(Box box, vec3 normal, float offset) {
  return dot(normal, box.centre) + dot(abs(rotate_back(box.t, normal)), box.half_size) +
             offset >= 0.0;
}

// Returns an entry of the list, with kOutOfView where no surfel of the block can be visible.
uint look_at(uint block) {
  uint keys[8] = bounds[block].reach;
  if (keys[0] == 0u) return block | kOutOfView;
  uint submap = submap_of(bounds[block]);
  if (submap == HERMITE_NONE) return block;
  vec3 high = vec3(unordered(keys[0]), unordered(keys[1]), unordered(keys[2]));
  vec3 low = -vec3(unordered(keys[3]), unordered(keys[4]), unordered(keys[5]));
  Transform t = camera_from_submap[submap];
  Box box = Box(transform_point(t, 0.5 * (high + low)), 0.5 * (high - low) + p.margin_m, t);
  // One pixel more on each side than index_cell tests compensates for rounding.
  float left = -1.5 - p.camera.cx, right = float(p.camera.width) + 0.5 - p.camera.cx;
  float top = -1.5 - p.camera.cy, bottom = float(p.camera.height) + 0.5 - p.camera.cy;
  bool seen = reaches(box, vec3(0.0, 0.0, 1.0), 0.0) &&
              reaches(box, vec3(0.0, 0.0, -1.0), p.depth_max_m) &&
              reaches(box, vec3(p.camera.fx, 0.0, -left), 0.0) &&
              reaches(box, vec3(-p.camera.fx, 0.0, right), 0.0) &&
              reaches(box, vec3(0.0, p.camera.fy, -top), 0.0) &&
              reaches(box, vec3(0.0, -p.camera.fy, bottom), 0.0);
  uint zone =
      zone_of_pixel(p.camera, project(p.camera, vec3(box.centre.xy, max(box.centre.z, 0.05))));
  return block | (zone << 16) | (seen ? 0u : kOutOfView);
}

// Returns how an entry counts: (1, 0) if it is its turn, (0, 1) if it is only visible, (0, 0)
// otherwise.
uvec2 kind_of(uint block, uint entry) {
  bool seen = (entry & kOutOfView) == 0u;
  bool in_turn = (block + p.frame_number) % (seen ? p.interval : p.interval_out_of_view) == 0u;
  return in_turn ? uvec2(1u, 0u) : uvec2(0u, seen ? 1u : 0u);
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint block_count = (state.slot_count + state.fresh_count + kBlock - 1u) / kBlock;
  uint share = (block_count + 255u) / 256u;
  uint first = min(lane * share, block_count), last = min(first + share, block_count);
  uvec2 count = uvec2(0u);
  for (uint block = first; block < last; ++block) count += kind_of(block, look_at(block));
  counts[lane] = count;
  barrier();
  if (lane == 0u) {
    total = uvec2(0u);
    for (uint i = 0u; i < 256u; ++i) {
      uvec2 here = counts[i];
      counts[i] = total;
      total += here;
    }
  }
  barrier();
  uvec2 next = uvec2(counts[lane].x, total.x + counts[lane].y);
  for (uint block = first; block < last; ++block) {
    uint entry = look_at(block);
    uvec2 kind = kind_of(block, entry);
    if (kind.x > 0u) visible_blocks[next.x] = entry;
    if (kind.y > 0u) visible_blocks[next.y] = entry;
    next += kind;
  }
  if (lane != 0u) return;
  head.groups = uint[3](total.x + total.y, 1u, 1u);
  head.turn_groups = uint[3](total.x, 1u, 1u);
}
