#include "core/adjust/landmarks.h"

#include <algorithm>

#include "core/adjust/aligned_match.h"
#include "core/base/check.h"

namespace hermite::adjust {
namespace {

// So that a blurred one does not interrupt the tracks.
constexpr std::size_t kLastKeyframes = 3;
// Bounds the time; about as many see one place in a slow pass.
constexpr std::size_t kMaxNearKeyframes = 30;
// With fewer, the pose is worse than usual, so the radius is doubled (as in the authors' program).
constexpr std::size_t kFewMatches = 20;
constexpr double kWideRadius = 2;

void append_once(std::vector<std::uint32_t>& keyframes, std::uint32_t keyframe) {
  if (keyframes.size() < kMaxNearKeyframes &&
      std::find(keyframes.begin(), keyframes.end(), keyframe) == keyframes.end())
    keyframes.push_back(keyframe);
}

// Returns the last keyframes, then the requested ones, then the covisible ones, so that the limit
// drops those that share least.
std::vector<std::uint32_t> near_keyframes(const SparseMap& map,
                                          const std::vector<std::uint32_t>& also) {
  std::vector<std::uint32_t> near;
  const auto count = static_cast<std::uint32_t>(map.keyframes.size());
  for (std::uint32_t i = 1; i <= std::min<std::uint32_t>(count, kLastKeyframes); ++i)
    append_once(near, count - i);
  for (const std::uint32_t keyframe : also) append_once(near, keyframe);
  const std::vector<std::uint32_t> centres = near;
  for (const std::uint32_t centre : centres) {
    if (near.size() == kMaxNearKeyframes) break;
    for (const Covisible& other : covisible(map, centre)) append_once(near, other.keyframe);
  }
  return near;
}

}  // namespace

InsertResult insert_keyframe(SparseMap& map, Keyframe keyframe,
                             const std::vector<std::uint32_t>& also) {
  CHECK(keyframe.submap < map.world_from_submap.size(), "the keyframe's submap is not in the map");
  CHECK(is_finite(keyframe.submap_from_camera), "the keyframe's pose is not finite");
  const std::vector<std::uint32_t> near = landmarks_of(map, near_keyframes(map, also));
  const Rigid3 pose = world_from_camera(map, keyframe);
  std::vector<LandmarkMatch> matches = match_aligned(map, near, keyframe.features, pose).matches;
  if (matches.size() < kFewMatches)
    matches = match_aligned(map, near, keyframe.features, pose,
                            kWideRadius * ProjectionOptions{}.radius_px)
                  .matches;

  InsertResult result;
  result.keyframe = static_cast<std::uint32_t>(map.keyframes.size());
  result.matched_count = static_cast<int>(matches.size());
  keyframe.landmark_of_feature.assign(keyframe.features.size(), kNoLandmark);
  map.keyframes.push_back(std::move(keyframe));
  for (const LandmarkMatch& match : matches) {
    add_observation(map, match.landmark, {result.keyframe, match.feature});
    if (map.landmarks[match.landmark].observations.size() == 2)
      result.repeated.push_back(match.landmark);
  }
  std::sort(result.repeated.begin(), result.repeated.end());

  const Keyframe& inserted = map.keyframes.back();
  for (std::uint32_t i = 0; i < inserted.features.size(); ++i) {
    const Feature& feature = inserted.features[i];
    if (feature.depth_m <= 0 || inserted.landmark_of_feature[i] != kNoLandmark) continue;
    const auto landmark = static_cast<std::uint32_t>(map.landmarks.size());
    const Eigen::Vector3d in_camera =
        map.camera.unproject(feature.pixel_px.x(), feature.pixel_px.y(), feature.depth_m);
    if (!in_camera.allFinite()) continue;
    map.landmarks.push_back(
        {inserted.submap, inserted.submap_from_camera * in_camera, feature.descriptor, {}});
    add_observation(map, landmark, {result.keyframe, i});
    result.created.push_back(landmark);
  }
  return result;
}

}  // namespace hermite::adjust
