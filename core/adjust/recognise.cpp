#include "core/adjust/recognise.h"

#include <algorithm>
#include <optional>

#include "core/adjust/aligned_match.h"

namespace hermite::adjust {
namespace {

// Least number of inliers of the matches by descriptor alone; the guided matches decide.
constexpr std::size_t kLeastSeedInliers = 8;
constexpr double kSamePlace_rad = M_PI / 6;

// Returns the keyframe of the place that sees most of these landmarks; the first one if several are
// equal.
std::uint32_t most_shared(const SparseMap& map, const std::vector<std::uint32_t>& keyframes,
                          const std::vector<LandmarkMatch>& matches) {
  std::vector<int> counts(map.keyframes.size(), 0);
  for (const LandmarkMatch& match : matches)
    for (const Observation& observation : map.landmarks[match.landmark].observations)
      ++counts[observation.keyframe];
  return *std::max_element(keyframes.begin(), keyframes.end(),
                           [&](std::uint32_t a, std::uint32_t b) { return counts[a] < counts[b]; });
}

std::optional<PlaceMatch> verify(const SparseMap& map, const std::vector<Feature>& features,
                                 PlaceCandidate candidate) {
  RansacOptions options;
  options.least_inliers = kLeastSeedInliers;
  const std::vector<PointPair> seeds = point_pairs(map, features, candidate.matches);
  const std::optional<RigidMatch> seed = match_rigidly(seeds, map.camera, options);
  if (!seed) return std::nullopt;

  const std::vector<std::uint32_t> landmarks = landmarks_of(map, candidate.keyframes);
  AlignedMatches guided = match_aligned(map, landmarks, features, seed->world_from_camera);
  const std::vector<PointPair> pairs = point_pairs(map, features, guided.matches);
  const std::optional<RigidMatch> match =
      refine_rigidly(pairs, map.camera, guided.world_from_camera, kLeastPlaceInliers);
  if (!match) return std::nullopt;

  PlaceMatch place;
  for (const std::uint32_t inlier : match->inliers) place.matches.push_back(guided.matches[inlier]);
  place.keyframe = most_shared(map, candidate.keyframes, place.matches);
  place.submap = map.keyframes[place.keyframe].submap;
  place.submap_from_camera =
      inverse(map.world_from_submap[place.submap]) * match->world_from_camera;
  return place;
}

bool same_place(const SparseMap& map, const PlaceMatch& a, const PlaceMatch& b) {
  const Rigid3 a_from_b = inverse(map.world_from_submap[a.submap] * a.submap_from_camera) *
                          (map.world_from_submap[b.submap] * b.submap_from_camera);
  return a_from_b.translation.norm() <= kSamePlace_m &&
         angle_rad(a_from_b.rotation) <= kSamePlace_rad;
}

}  // namespace

std::vector<PlaceMatch> recognise(const SparseMap& map, const PlaceIndex& index,
                                  const std::vector<Feature>& features,
                                  const std::vector<std::uint32_t>& excluded) {
  std::vector<PlaceMatch> found;
  for (PlaceCandidate& candidate : index.query(features, map, excluded))
    if (auto place = verify(map, features, std::move(candidate)))
      found.push_back(*std::move(place));
  std::stable_sort(found.begin(), found.end(), [](const PlaceMatch& a, const PlaceMatch& b) {
    return a.matches.size() > b.matches.size();
  });
  std::vector<PlaceMatch> places;
  for (PlaceMatch& match : found)
    if (std::none_of(places.begin(), places.end(),
                     [&](const PlaceMatch& better) { return same_place(map, better, match); }))
      places.push_back(std::move(match));
  return places;
}

}  // namespace hermite::adjust
