#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Removes invalid surfels (paper section 5) from the blocks whose turn it is, and updates the
// blocks' bounds:
//   redundant   most neighbours in 5x5 pixels of the index map of stable surfels are older and just
//               behind it
//   doubled     just behind an older stable surfel of another submap that is not coarser: submaps
//               overlap
//   free space  stable surfels observed in this frame are clearly behind it
//   refuted     unstable, not observed for a while, and this frame measures something clearly
//               behind it
//   unstable    not confirmed for max_unstable_age frames
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) writeonly buffer Positions { vec4 position_confidence[]; };
TEXELS(1, attributes);
TEXELS(2, times);  // per slot: frames of creation and last observation
TEXELS(3, camera_from_submap);
TEXELS(4, seen);  // per pixel of the index map of stable surfels; see map/index_times
layout(scalar, binding = 5) buffer State { MapState state; };
TEXELS(6, visible_blocks);
layout(scalar, binding = 7) writeonly buffer Bounds { BlockBounds bounds[]; };
TEXELS(8, read_position_confidence);  // a surfel is written by its own thread only
TEXELS(9, raw_depth_m);               // of this frame, per pixel
PARAMETERS(CleanParams, p);
const float kDead = 1e30;  // not a valid coordinate
// Frames without an observation after which an unstable surfel can be refuted.
const uint kPatience = 10u;
shared float position_submap[4u * kBlock];  // by coordinate, the submap last

bool doubled(uint slot, ivec2 pixel, float z, SurfelAttributes a, uint created) {
  uvec4 shown = uvec4_at(seen, uint(pixel.y) * p.camera.width + uint(pixel.x));
  if (shown.x == HERMITE_NONE || shown.x == slot ||
      z - uintBitsToFloat(shown.y) > p.redundancy_depth_m)
    return false;
  SurfelAttributes b = attributes_at(attributes, shown.x);
  return surfel_submap(b) != surfel_submap(a) && shown.z < created &&
         surfel_radius(b) <= 1.5 * surfel_radius(a);
}

// Returns whether an unstable surfel, once observed, is now seen through: it was noise or has
// moved. The raw depth is tested, because the surfel hides stable ones behind it from association,
// so these do not count as observed. It is tested around the pixel too, because at an edge both
// sides are measured.
bool refuted(uint slot, ivec2 pixel, float z, float confidence, bool visible) {
  bool doubtful = visible && confidence < p.stable_confidence &&
                  p.frame_number - uvec2_at(times, slot).y >= kPatience;
  bool measured = false, behind = true;
  int last = doubtful ? 1 : -2;
  for (int dy = -1; dy <= last; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      ivec2 q = pixel + ivec2(dx, dy);
      if (!inside(p.camera, q)) continue;
      float depth_m = float_at(raw_depth_m, uint(q.y) * p.camera.width + uint(q.x));
      if (depth_m <= 0.0) continue;
      measured = measured || (dx == 0 && dy == 0);
      behind = behind && depth_m - z > p.depth_gate_m;
    }
  }
  return measured && behind;
}

bool contradicted(uint slot, vec4 surfel) {
  SurfelAttributes a = attributes_at(attributes, slot);
  Transform t = transform_at(camera_from_submap, surfel_submap(a));
  vec3 point = transform_point(t, surfel.xyz);
  ivec2 pixel = ivec2(floor(project(p.camera, point) + 0.5));
  bool visible = point.z > 0.05 && inside(p.camera, pixel);
  float radius = surfel_radius(a);
  uint created = uvec2_at(times, slot).x;
  float normal_z = abs(rotate(t, unpack_unit(a.normal)).z);
  int neighbours = 0, redundant = 0, seen_through = 0;
  // A whole subgroup leaves an empty loop at once, while software devices execute a skipped `if`
  // under a mask.
  int last = visible ? 2 : -3;
  for (int dy = -2; dy <= last; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      ivec2 q = pixel + ivec2(dx, dy);
      if (!inside(p.camera, q)) continue;
      uvec4 other = uvec4_at(seen, uint(q.y) * p.camera.width + uint(q.x));
      if (other.x == HERMITE_NONE || other.x == slot) continue;
      ++neighbours;
      float gap = uintBitsToFloat(other.y) - point.z;
      vec2 lateral = vec2(dx, dy) * point.z / vec2(p.camera.fx, p.camera.fy);
      bool far_behind = gap >= p.redundancy_depth_m;
      bool just_behind = gap > 0.0 && !far_behind && dot(lateral, lateral) < 1.96 * radius * radius;
      redundant += just_behind && other.z < created ? 1 : 0;
      seen_through += far_behind && other.w == p.frame_number && normal_z > 0.85 ? 1 : 0;
    }
  }
  if (visible && doubled(slot, pixel, point.z, a, created)) return true;
  if (refuted(slot, pixel, point.z, surfel.w, visible)) return true;
  // More than half, or more than a quarter, of the neighbours; fewer than three may be an edge.
  return (redundant > 2 && 2 * redundant > neighbours) ||
         (seen_through > 2 && 4 * seen_through > neighbours);
}

bool outlived(vec4 surfel, uint slot) {
  vec2 kappa = unpackHalf2x16(attributes_at(attributes, slot).curvatures);
  return (surfel.w < p.stable_confidence &&
          p.frame_number - uvec2_at(times, slot).y > p.max_unstable_age) ||
         max(abs(kappa.x), abs(kappa.y)) > p.curvature_limit_per_m;
}

void write_bounds(uint block) {
  uint direction = gl_LocalInvocationID.x;
  if (direction >= 8u) return;
  uint farthest = 0u;
  uint first = kBlock * coordinate_of(direction);
  for (uint i = first; i < first + kBlock; ++i) {
    float value = position_submap[i];
    farthest = value != kDead ? max(farthest, ordered(sign_of(direction) * value)) : farthest;
  }
  bounds[block].reach[direction] = farthest;
}

void main() {
  uint lane = gl_LocalInvocationID.x,
       block = block_of(listed_block(visible_blocks, gl_WorkGroupID.x)),
       slot = block * kBlock + lane;
  // Includes surfels appended by fusion; the count itself is updated after this pass.
  bool exists = slot < state.slot_count + state.fresh_count;
  vec4 surfel = exists ? vec4_at(read_position_confidence, slot) : vec4(0.0);
  bool alive = surfel.w > 0.0;
  if (alive && (contradicted(slot, surfel) || outlived(surfel, slot))) {
    alive = false;
    // map/free_list writes the frame of the removal, because neighbours may still read the last
    // observation here.
    position_confidence[slot].w = -1.0;
    atomicAdd(state.freed_count, 1u);
  }
  for (uint i = 0u; i < 3u; ++i) position_submap[kBlock * i + lane] = alive ? surfel[i] : kDead;
  position_submap[kBlock * 3u + lane] =
      alive ? float(surfel_submap(attributes_at(attributes, slot))) : kDead;
  barrier();
  write_bounds(block);
}
