// The sparse map: keyframes and the landmarks they see. Bundle adjustment corrects it, and a lost
// camera is relocalised in it. Plain data without images. Landmarks and keyframes live in the frame
// of a submap, so a rigid correction changes only world_from_submap.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/adjust/depth_planes.h"
#include "core/adjust/features.h"
#include "core/math/rigid3.h"

namespace hermite::adjust {

inline constexpr std::int32_t kNoLandmark = -1;

struct Keyframe {
  std::int64_t frame_index = 0;
  std::uint32_t submap = 0;
  Rigid3 submap_from_camera;
  std::vector<Feature> features;
  std::vector<std::int32_t> landmark_of_feature;  // one per feature; kNoLandmark: none
  // One per cell of depth_grid_of(the map's camera); empty if not computed.
  std::vector<DepthPlane> planes{};
};

struct Observation {
  std::uint32_t keyframe = 0;
  std::uint32_t feature = 0;
  bool operator==(const Observation&) const = default;
};

struct Landmark {
  std::uint32_t submap = 0;
  Eigen::Vector3d position_in_submap_m = Eigen::Vector3d::Zero();
  Descriptor descriptor{};  // the medoid of the descriptors of its observations
  // Ascending keyframes, one each; empty: a tombstone, whose index is never reused.
  std::vector<Observation> observations;
};

// Indices into these vectors never change: nothing is ever removed. A landmark lists an observation
// exactly if that feature refers to the landmark.
struct SparseMap {
  Camera camera;
  std::vector<Keyframe> keyframes;
  std::vector<Landmark> landmarks;
  std::vector<Rigid3> world_from_submap;
};

Rigid3 world_from_camera(const SparseMap& map, const Keyframe& keyframe);
Eigen::Vector3d position_in_world_m(const SparseMap& map, const Landmark& landmark);

// Returns the standard deviation [m] of the landmark's position: that of the depth at the nearest
// observation; 0 if no observation has depth.
double position_sigma_m(const SparseMap& map, const Landmark& landmark);

struct Covisible {
  std::uint32_t keyframe = 0;
  int shared_count = 0;  // landmarks seen by both
  bool operator==(const Covisible&) const = default;
};

// Keyframes are covisible if they share at least this many landmarks.
inline constexpr int kLeastShared = 15;

// Returns the other keyframes that share at least `least_shared` landmarks with this one, most
// first, older ones first if equal. The authors and ORB-SLAM use 15: fewer shared landmarks do not
// determine a pose well.
std::vector<Covisible> covisible(const SparseMap& map, std::uint32_t keyframe,
                                 int least_shared = kLeastShared);

// Returns the landmarks seen by any of these keyframes, ascending, without duplicates.
std::vector<std::uint32_t> landmarks_of(const SparseMap& map,
                                        const std::vector<std::uint32_t>& keyframes);

// Adds an observation of the landmark by `feature` of `keyframe` and updates the landmark's
// descriptor. The feature must have no landmark yet, and the landmark no observation by that
// keyframe.
void add_observation(SparseMap& map, std::uint32_t landmark, const Observation& observation);

// Merges two landmarks that are one point: the observations of `from` move to `into`, whose
// position does not change, and `from` becomes a tombstone. Where a keyframe sees both, it keeps
// its observation of `into`, and its other feature loses its landmark.
void merge_landmarks(SparseMap& map, std::uint32_t from, std::uint32_t into);

// Removes an observation of the landmark, which must exist (an outlier of an adjustment). A
// landmark without observations becomes a tombstone.
void remove_observation(SparseMap& map, std::uint32_t landmark, const Observation& observation);

// Removes all observations of the landmark, which becomes a tombstone.
void bury_landmark(SparseMap& map, std::uint32_t landmark);

}  // namespace hermite::adjust
