// The surfel as it lies in memory (40 bytes, three arrays) and push constants of the passes over the map.
#ifndef HERMITE_SHARED_MAP_H
#define HERMITE_SHARED_MAP_H

#include "shaders/shared/types.h"

#ifdef __cplusplus
namespace hermite::shared {
#endif

// Array 0: vec4 position in the submap's frame [m] and confidence (0: the slot is free).
// Array 1: uvec4, see below. Array 2: uvec2, frame numbers of creation and of the last observation.
struct SurfelAttributes {
  uint normal;           // octahedral, 2 x snorm16, in the submap's frame, away from the camera
  uint radius_submap;    // half float [m] | submap << 16
  uint color;            // r | g << 8 | b << 16
  uint curvatures;       // 2 x half float, max then min [1/m]
};

// Counters of the map, in a buffer of their own.
struct MapState {
  uint slot_count;   // slots in use or free below this
  uint free_count;   // of these, free ones (listed in order)
  uint new_count;    // being appended; 0 between frames
};

struct IndexParams {
  Intrinsics camera;
  float min_confidence;
  float depth_max_m;
  uint slot_count;
};

struct PredictParams {
  Intrinsics camera;
  float curvature_lambda_per_m;  // curvature at which a surface starts to count as a feature (reference, section 2.4)
  float confidence_scale;
  uint min_support;              // kernels that must support the solution
  uint max_iterations;
  uint correct_bias;
  uint hrbf;                     // 0: surfel splatting, for comparison
};

struct FillInParams {
  uint pixel_count;
  float curvature_lambda_per_m;
  float confidence_scale;
  uint covered_below;  // fill only when the prediction covers fewer pixels
  uint with_color;     // 0: the frame's picture is not to be believed
};

struct FuseParams {
  Intrinsics camera;
  uint frame_number;
  uint slot_capacity;
  float depth_gate_m;          // along the ray
  float cos_normal_gate;
  float max_confidence;
  float curvature_limit_per_m;
  uint submap;                 // new surfels belong to it
  uint fuse_surface;           // 1: fuse the HRBF surface, 0: the raw depth
  float radius_scale;
  uint merge_color;            // 0: surfels keep their colour
};

struct CleanParams {
  Intrinsics camera;
  uint frame_number;
  uint interval;               // every so-many-th workgroup is looked at, another one in every frame
  float stable_confidence;
  uint max_unstable_age;       // frames
  float redundancy_depth_m;
  float curvature_limit_per_m;
};

struct FreeListParams {
  uint frame_number;
};

struct ScanParams {
  uint group_count;
  uint ends_frame;  // 0: the counts are of new surfels, 1: of free slots, which also brings slot_count up to date
};

#ifdef __cplusplus
}  // namespace hermite::shared
#endif
#endif
