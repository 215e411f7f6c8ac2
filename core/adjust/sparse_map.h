// Keyframes and the landmarks they see: what bundle adjustment moves and what a lost camera is found in. Plain data, no copies of images.
// Landmarks and keyframes live in the frame of a submap, which moves rigidly: a correction changes world_from_submap alone.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/adjust/depth_planes.h"
#include "core/adjust/features.h"
#include "core/math/rigid3.h"

namespace hermite {

inline constexpr std::int32_t kNoLandmark = -1;

struct Keyframe {
  std::int64_t frame_index = 0;
  std::uint32_t submap = 0;
  Rigid3 submap_from_camera;
  std::vector<Feature> features;
  std::vector<std::int32_t> landmark_of_feature;  // one per feature, kNoLandmark: none
  std::vector<DepthPlane> planes{};               // of depth_grid_of(the map's camera); empty: it has none
};

struct Observation {
  std::uint32_t keyframe = 0;
  std::uint32_t feature = 0;
  bool operator==(const Observation&) const = default;
};

struct Landmark {
  std::uint32_t submap = 0;
  Eigen::Vector3d position_in_submap_m = Eigen::Vector3d::Zero();
  Descriptor descriptor{};                // the medoid of its observations'
  std::vector<Observation> observations;  // ascending keyframes, one each; none: a tombstone, which keeps its index for ever
};

// Indices are those of the vectors and never change: nothing is ever taken out. A landmark lists an observation exactly when that feature
// names the landmark.
struct SparseMap {
  Camera camera;
  std::vector<Keyframe> keyframes;
  std::vector<Landmark> landmarks;
  std::vector<Rigid3> world_from_submap;
};

Rigid3 world_from_camera(const SparseMap& map, const Keyframe& keyframe);
Eigen::Vector3d position_in_world_m(const SparseMap& map, const Landmark& landmark);

// Standard deviation of the landmark's position [m]: that of the depth from where it was seen nearest; 0 when no observation has depth.
double position_sigma_m(const SparseMap& map, const Landmark& landmark);

struct Covisible {
  std::uint32_t keyframe = 0;
  int shared_count = 0;  // landmarks that both see
  bool operator==(const Covisible&) const = default;
};

// The other keyframes that share at least `least_shared` landmarks with this one, most first, the older of equals first.
// 15 is the authors' (and ORB-SLAM's) number: fewer shared landmarks do not fix a pose well.
inline constexpr int kLeastShared = 15;
std::vector<Covisible> covisible(const SparseMap& map, std::uint32_t keyframe, int least_shared = kLeastShared);

// The landmarks that any of these keyframes sees, ascending, each once.
std::vector<std::uint32_t> landmarks_of(const SparseMap& map, const std::vector<std::uint32_t>& keyframes);

// `feature` of `keyframe` is one more observation of the landmark, whose descriptor follows. The feature has no landmark yet, and the
// landmark no observation by that keyframe.
void add_observation(SparseMap& map, std::uint32_t landmark, const Observation& observation);

// They are one point of the world: the observations of `from` move to `into`, whose position stays, and `from` becomes a tombstone. Where a
// keyframe sees both, it keeps its observation of `into` and its other feature loses its landmark.
void merge_landmarks(SparseMap& map, std::uint32_t from, std::uint32_t into);

// The keyframe does not see the landmark after all (an outlier of an adjustment); it has to be one of its observations. Without any left
// the landmark is a tombstone.
void remove_observation(SparseMap& map, std::uint32_t landmark, const Observation& observation);

// All of them at once.
void bury_landmark(SparseMap& map, std::uint32_t landmark);

}  // namespace hermite
