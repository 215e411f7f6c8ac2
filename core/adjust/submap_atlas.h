// The submaps of a scan with their keyframes and links, and the camera among them: in which submap
// it is, and which submaps it is tracked against. Plain data and functions on it.
//
// Loops and adjustments change the poses in `map` first; `layout` is what the front end sees, and
// takes them over with publish() or publish_correction(). Until then it lags behind.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/adjust_options.h"
#include "core/adjust/mapping.h"
#include "core/adjust/sparse_map.h"
#include "core/adjust/submap_graph.h"

namespace hermite::adjust {

// Between two submaps of different components the camera was lost. Where the second is relative to
// the first is not known, but not farther away than a camera can come in that time.
struct SightLoss {
  std::uint32_t before = 0, after = 0;                     // submaps
  Eigen::Vector3d last_place_m = Eigen::Vector3d::Zero();  // of the camera, in `before`
  // Greatest distance from there to the origin of `after`.
  double reach_m = 0;
};

// `map`, `graph` and `layout` have the same number of submaps, at least one; the graph's components
// are those below `component_count`.
struct SubmapAtlas {
  SparseMap map;
  SubmapGraph graph;
  MapLayout layout;
  std::uint32_t component_count = 1;
  std::vector<SightLoss> losses;
  std::int64_t frame = -1;    // index of the last observed frame
  Rigid3 submap_from_camera;  // pose of the last observed frame in the current submap
};

// Returns an atlas whose only submap is that of the first camera pose, in the world frame.
SubmapAtlas make_submap_atlas(const Camera& camera);

Rigid3 world_from_camera(const SubmapAtlas& atlas);

// Adds an active submap without links and returns its index. The camera stays in its submap.
std::uint32_t open_submap(SubmapAtlas& atlas, const Rigid3& world_from_submap,
                          std::uint32_t component);

// Opens the first submap of a new component, at the pose of a camera that was lost and can have
// come `reach_m` far.
std::uint32_t open_component(SubmapAtlas& atlas, const Rigid3& world_from_camera, double reach_m);

// Returns whether two submaps that have been joined are farther apart than the camera can have come
// while it was lost.
bool is_out_of_reach(const SubmapAtlas& atlas);

// The camera goes on in this submap, at this pose.
void enter_submap(SubmapAtlas& atlas, std::uint32_t submap, const Rigid3& world_from_camera,
                  const AdjustOptions& options);

// When the camera leaves the reach of the current submap, it continues in an existing one or opens
// a new one. Returns whether it opened one.
bool choose_submap(SubmapAtlas& atlas, const AdjustOptions& options);

// Marks the submaps that the camera is tracked against: those within a path so short that tracking
// has not drifted. Call it when links or components have changed.
void update_active(SubmapAtlas& atlas, const AdjustOptions& options);

// Returns the submaps of the component, ascending.
std::vector<std::uint32_t> submaps_of(const SubmapGraph& graph, std::uint32_t component);

// Returns the keyframes of the camera's component that are near the camera, nearest first: those in
// active submaps, or those in inactive ones.
std::vector<std::uint32_t> keyframes_near(const SubmapAtlas& atlas, double distance_m,
                                          double turn_rad, bool active);

// Returns such keyframes that show much of the same surface as the camera sees.
std::vector<std::uint32_t> keyframes_in_view(const SubmapAtlas& atlas, bool active);

// Returns whether no keyframe of an active submap is near the camera.
bool is_new_view(const SubmapAtlas& atlas, const AdjustOptions& options);

// Returns the submaps of the component with a keyframe whose view is near that of a camera at this
// pose.
std::vector<bool> submaps_in_view(const SubmapAtlas& atlas, const Rigid3& world_from_camera,
                                  std::uint32_t component);

// Returns the submap among these whose origin is nearest to the pose; the current one if there are
// none.
std::uint32_t nearest_submap(const SubmapAtlas& atlas, const std::vector<bool>& among,
                             const Rigid3& world_from_camera);

// Returns a candidate with the inactive submaps of the component of `submap` that a camera at this
// pose could see.
LoopCandidate candidate_at(const SubmapAtlas& atlas, const Rigid3& world_from_camera,
                           std::uint32_t submap, bool by_appearance);

bool is_of_another_component(const SubmapAtlas& atlas, const LoopCandidate& candidate);

// Copies the present poses and components into the layout, which the front end sees.
void publish(SubmapAtlas& atlas);

// The same after submaps have moved.
void publish_correction(SubmapAtlas& atlas);

}  // namespace hermite::adjust
