#include "core/adjust/repetition.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/adjust/aligned_match.h"
#include "core/adjust/recognise.h"

namespace hermite::adjust {

namespace {

// Landmarks that lie nearer are where the pose says, up to drift and noise.
constexpr double kHere_m = 0.15;

// Of what recurs only a part need be known.
constexpr std::size_t kLeastElsewhere = 8;

// In recordings of a kitchen and of a desk 0 to 4 % of what is here is elsewhere as well, in a
// rendered living room with cushions and chairs up to 18 %; between identical desks, at wrong
// places, 50 % and more.
constexpr double kRecurringShare = 0.2;

// Returns the landmarks that one of the first keyframes has seen.
std::vector<std::uint32_t> landmarks_of_first(const SparseMap& map, std::int64_t keyframes) {
  std::vector<std::uint32_t> first(
      static_cast<std::size_t>(std::clamp<std::int64_t>(keyframes, 0, std::ssize(map.keyframes))));
  std::iota(first.begin(), first.end(), 0u);
  return landmarks_of(map, first);
}

std::size_t feature_count(const std::vector<LandmarkMatch>& matches) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < matches.size(); ++i)
    count += i == 0 || matches[i].feature != matches[i - 1].feature ? 1 : 0;
  return count;
}

}  // namespace

bool is_distinctive(const Repetition& r) {
  return r.here >= kLeastPlaceInliers &&
         static_cast<double>(r.elsewhere) < kRecurringShare * static_cast<double>(r.here);
}

Repetition repetition_of(const SparseMap& map, const PlaceIndex& index,
                         const std::vector<Feature>& features, const Rigid3& world_from_camera,
                         std::int64_t known_keyframes) {
  std::vector<LandmarkMatch> matches = index.similar(features, map);
  std::erase_if(matches, [&](const LandmarkMatch& match) {
    return map.landmarks[match.landmark].observations.front().keyframe >= known_keyframes;
  });
  std::vector<LandmarkMatch> here, far;
  const std::vector<PointPair> pairs = point_pairs(map, features, matches);
  std::vector<PointPair> far_pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double distance_m =
        (world_from_camera * pairs[i].point_in_camera_m - pairs[i].point_in_world_m).norm();
    if (distance_m < kHere_m) here.push_back(matches[i]);
    if (distance_m < kSamePlace_m) continue;
    far.push_back(matches[i]);
    far_pairs.push_back(pairs[i]);
  }
  // The index has only what was seen from several places, which is nothing if the camera stands on
  // a tripod.
  const std::vector<LandmarkMatch> expected =
      match_projected(map, landmarks_of_first(map, known_keyframes), features, world_from_camera);
  Repetition repetition{std::max(feature_count(here), expected.size()), 0};
  if (const std::optional<RigidMatch> other =
          match_rigidly(far_pairs, map.camera, {.least_inliers = kLeastElsewhere})) {
    std::vector<LandmarkMatch> inliers;
    for (const std::uint32_t inlier : other->inliers) inliers.push_back(far[inlier]);
    repetition.elsewhere = feature_count(inliers);
  }
  return repetition;
}

}  // namespace hermite::adjust
