#include "core/adjust/sparse_map.h"

#include <algorithm>

#include "core/adjust/bundle_noise.h"
#include "core/base/check.h"

namespace hermite::adjust {
namespace {

// The medoid takes quadratic time, so for longer tracks it uses this many observations, evenly
// spread from the first to the last.
constexpr std::size_t kMaxMedoidCount = 16;

const Feature& feature_of(const SparseMap& map, const Observation& observation) {
  return map.keyframes[observation.keyframe].features[observation.feature];
}

void update_descriptor(const SparseMap& map, Landmark& landmark) {
  const std::size_t count = std::min(landmark.observations.size(), kMaxMedoidCount);
  std::vector<Descriptor> descriptors;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = count < 2 ? 0 : i * (landmark.observations.size() - 1) / (count - 1);
    descriptors.push_back(feature_of(map, landmark.observations[at]).descriptor);
  }
  landmark.descriptor = descriptors[medoid(descriptors)];
}

bool earlier(const Observation& a, const Observation& b) { return a.keyframe < b.keyframe; }

}  // namespace

Rigid3 world_from_camera(const SparseMap& map, const Keyframe& keyframe) {
  return map.world_from_submap[keyframe.submap] * keyframe.submap_from_camera;
}

Eigen::Vector3d position_in_world_m(const SparseMap& map, const Landmark& landmark) {
  return map.world_from_submap[landmark.submap] * landmark.position_in_submap_m;
}

double position_sigma_m(const SparseMap& map, const Landmark& landmark) {
  double nearest_m = 0;
  for (const Observation& observation : landmark.observations) {
    const double depth_m = feature_of(map, observation).depth_m;
    if (depth_m > 0 && (nearest_m == 0 || depth_m < nearest_m)) nearest_m = depth_m;
  }
  return nearest_m > 0 ? depth_deviation_m(nearest_m) : 0;
}

std::vector<Covisible> covisible(const SparseMap& map, std::uint32_t keyframe, int least_shared) {
  std::vector<int> shared(map.keyframes.size(), 0);
  for (const std::int32_t landmark : map.keyframes[keyframe].landmark_of_feature) {
    if (landmark == kNoLandmark) continue;
    for (const Observation& observation :
         map.landmarks[static_cast<std::size_t>(landmark)].observations)
      ++shared[observation.keyframe];
  }
  std::vector<Covisible> found;
  for (std::uint32_t other = 0; other < shared.size(); ++other)
    if (other != keyframe && shared[other] >= least_shared) found.push_back({other, shared[other]});
  std::stable_sort(found.begin(), found.end(), [](const Covisible& a, const Covisible& b) {
    return a.shared_count > b.shared_count;
  });
  return found;
}

std::vector<std::uint32_t> landmarks_of(const SparseMap& map,
                                        const std::vector<std::uint32_t>& keyframes) {
  std::vector<std::uint32_t> seen;
  for (const std::uint32_t keyframe : keyframes)
    for (const std::int32_t landmark : map.keyframes[keyframe].landmark_of_feature)
      if (landmark != kNoLandmark) seen.push_back(static_cast<std::uint32_t>(landmark));
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

void add_observation(SparseMap& map, std::uint32_t landmark, const Observation& observation) {
  std::int32_t& of_feature =
      map.keyframes[observation.keyframe].landmark_of_feature[observation.feature];
  CHECK(of_feature == kNoLandmark, "the feature already has a landmark");
  auto& observations = map.landmarks[landmark].observations;
  const auto place =
      std::lower_bound(observations.begin(), observations.end(), observation, earlier);
  CHECK(place == observations.end() || place->keyframe != observation.keyframe,
        "the keyframe already sees the landmark");
  observations.insert(place, observation);
  of_feature = static_cast<std::int32_t>(landmark);
  update_descriptor(map, map.landmarks[landmark]);
}

void merge_landmarks(SparseMap& map, std::uint32_t from, std::uint32_t into) {
  CHECK(from != into, "a landmark cannot be merged with itself");
  Landmark& target = map.landmarks[into];
  CHECK(!target.observations.empty(), "a landmark cannot be merged into a tombstone");
  for (const Observation& observation : map.landmarks[from].observations) {
    std::int32_t& of_feature =
        map.keyframes[observation.keyframe].landmark_of_feature[observation.feature];
    const auto place = std::lower_bound(target.observations.begin(), target.observations.end(),
                                        observation, earlier);
    const bool seen_already =
        place != target.observations.end() && place->keyframe == observation.keyframe;
    of_feature = seen_already ? kNoLandmark : static_cast<std::int32_t>(into);
    if (!seen_already) target.observations.insert(place, observation);
  }
  map.landmarks[from].observations.clear();
  update_descriptor(map, target);
}

void remove_observation(SparseMap& map, std::uint32_t landmark, const Observation& observation) {
  CHECK(std::erase(map.landmarks[landmark].observations, observation) == 1,
        "the landmark has no such observation");
  map.keyframes[observation.keyframe].landmark_of_feature[observation.feature] = kNoLandmark;
  if (!map.landmarks[landmark].observations.empty())
    update_descriptor(map, map.landmarks[landmark]);
}

void bury_landmark(SparseMap& map, std::uint32_t landmark) {
  for (const Observation& observation : map.landmarks[landmark].observations)
    map.keyframes[observation.keyframe].landmark_of_feature[observation.feature] = kNoLandmark;
  map.landmarks[landmark].observations.clear();
}

}  // namespace hermite::adjust
