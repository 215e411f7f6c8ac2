// The memory layout of surfels (40 bytes in three arrays) and push constants of the passes over the
// map.
#ifndef HERMITE_SHARED_MAP_H
#define HERMITE_SHARED_MAP_H

#include "shaders/shared/types.h"

#ifdef __cplusplus
namespace hermite::shared {
#endif

// Array 0: vec4 position in the submap's coordinate frame [m] and confidence (0: the slot is free).
// Array 1: uvec4, see below. Array 2: uvec2, frame numbers of creation and of the last observation.
struct SurfelAttributes {
  // Octahedral, 2 x snorm16, in the submap's coordinate frame, away from the camera.
  uint normal;
  uint radius_submap;  // half float [m] | submap << 16
  // r | g << 11 | b << 22: red and green in eighths, blue in quarters of one in 255.
  uint color;
  uint curvatures;  // 2 x half float, max then min [1/m]
};

// Counters of the map, in a separate buffer.
#define HERMITE_ZONES 16
struct ZoneSlots {
  uint free_begin, free_count;  // in the list of free slots
  uint new_begin;               // of the zone's new surfels, in the order of all new surfels
  uint fresh_begin;             // of those without a free slot, counted from slot_count
};
struct MapState {
  uint slot_count;   // slots in use or free below this
  uint free_count;   // number of these that are free and listed for use
  uint new_count;    // being appended; 0 between frames
  uint fresh_count;  // number of these that are placed after slot_count
  uint alive_count;
  uint freed_count;    // in this frame; 0 between frames
  uint new_groups[3];  // workgroups of a dispatch over what is being appended
  ZoneSlots zones[HERMITE_ZONES];
};

// Side of the tiles in which fusion processes the image, in pixels.
#define HERMITE_TILE_SIDE 16

// Bounds of 256 neighbouring slots, see shaders/lib/blocks.glsl.
struct BlockBounds {
  uint reach[8];
};

// At the beginning of the list of blocks made by shaders/map/visible.comp; the entries
// (shaders/lib/blocks.glsl) follow it.
struct VisibleHead {
  uint groups[3];  // workgroups of a dispatch over the whole list
  // Workgroups of a dispatch over the blocks whose turn for cleaning it is, which are listed first.
  uint turn_groups[3];
};
#define HERMITE_VISIBLE_HEAD_WORDS 6
#ifdef __cplusplus
static_assert(sizeof(VisibleHead) == HERMITE_VISIBLE_HEAD_WORDS * sizeof(uint));
#endif

struct VisibleParams {
  Intrinsics camera;
  float depth_max_m;
  float margin_m;  // the largest distance by which a merge may move a surfel
  uint frame_number;
  // It is the turn of every n-th block, a different one in each frame.
  uint interval, interval_out_of_view;
};

struct IndexParams {
  Intrinsics camera;
  float min_confidence;
  float depth_max_m;
};

// The nearest surfel of a pixel of the index map. The device treats it as one 64-bit number: the
// least is the nearest, and of equal ones that of the lowest slot.
struct NearestSurfel {
  uint slot;        // kNoSurfel if there is none
  uint depth_bits;  // of a float [m]
};

// The same with the surfel data that association needs.
struct IndexCell {
  uint slot, depth_bits;
  uint offset;  // from the pixel's centre, half pixels, 2 x snorm16
  uint normal;  // octahedral, camera frame
};

struct PredictParams {
  Intrinsics camera;
  // Curvature at which a surface starts to count as a feature (core/METHOD.md, "Geometric term").
  float curvature_lambda_per_m;
  float confidence_scale;
  uint min_support;  // kernels that must support the solution
  uint max_iterations;
  uint correct_bias;
  uint hrbf;  // 0: surfel splatting, for comparison
};

struct FillInParams {
  uint pixel_count;
  float curvature_lambda_per_m;
  float confidence_scale;
  uint covered_below;  // fill only when the prediction covers fewer pixels
  uint with_color;     // 0: the frame's colour must not be used
  float gain, offset;  // as in FuseParams
};

struct FuseParams {
  Intrinsics camera;
  uint frame_number;
  uint slot_capacity;
  float depth_gate_m;  // along the ray
  float cos_normal_gate;
  float max_confidence;
  float curvature_limit_per_m;
  uint submap;           // new surfels belong to it
  uint fuse_surface;     // 1: fuse the HRBF surface, 0: the raw depth
  uint weigh_by_radius;  // 1: means are weighed by confidence / radius^2, 0: by confidence
  float radius_scale;
  uint color_use;      // 0: surfels keep their colour, 1: get the mean, 2: take the frame's
  float gain, offset;  // colour of the frame = gain * colour of the map + offset
  uint add_new;        // 0: only existing surfels are updated
};

struct CleanParams {
  Intrinsics camera;
  uint frame_number;
  float stable_confidence;
  uint max_unstable_age;  // frames
  float redundancy_depth_m;
  float curvature_limit_per_m;
  float depth_gate_m;  // closer surfels may be on the same surface
};

struct FreeListParams {
  uint frame_number;
  uint submap;  // of the next new surfels
};

struct ListNewParams {
  Intrinsics camera;
  uint tile_count;
};

struct ScanParams {
  Intrinsics camera;
  // The counts are of new surfels by tile; 0: of free slots by listed block, which also updates the
  // counters.
  uint tile_count;
};

#ifdef __cplusplus
}  // namespace hermite::shared
#endif
#endif
