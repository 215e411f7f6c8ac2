#include "core/adjust/recognise.h"

#include <algorithm>
#include <optional>

#include "core/adjust/rigid_ransac.h"

namespace hermite {
namespace {

constexpr std::size_t kLeastSeedInliers = 8;  // of the matches by descriptor alone; the guided ones decide
constexpr double kSamePlace_m = 0.5;
constexpr double kSamePlace_rad = M_PI / 6;

// Pairs of the matches whose feature has depth, which stay in `matches`.
std::vector<PointPair> pairs_of(const SparseMap& map, const std::vector<Feature>& features, std::vector<LandmarkMatch>& matches) {
  std::erase_if(matches, [&](const LandmarkMatch& match) { return features[match.feature].depth_m <= 0; });
  std::vector<PointPair> pairs;
  pairs.reserve(matches.size());
  for (const LandmarkMatch& match : matches) {
    const Feature& feature = features[match.feature];
    const Landmark& landmark = map.landmarks[match.landmark];
    pairs.push_back({map.camera.unproject(feature.pixel_px.x(), feature.pixel_px.y(), feature.depth_m), position_in_world_m(map, landmark),
                     octave_scale(feature.octave), position_sigma_m(map, landmark)});
  }
  return pairs;
}

// The keyframe of the place that sees most of these landmarks, the first of equals.
std::uint32_t most_shared(const SparseMap& map, const std::vector<std::uint32_t>& keyframes, const std::vector<LandmarkMatch>& matches) {
  std::vector<int> counts(map.keyframes.size(), 0);
  for (const LandmarkMatch& match : matches)
    for (const Observation& observation : map.landmarks[match.landmark].observations) ++counts[observation.keyframe];
  return *std::max_element(keyframes.begin(), keyframes.end(), [&](std::uint32_t a, std::uint32_t b) { return counts[a] < counts[b]; });
}

std::optional<PlaceMatch> verify(const SparseMap& map, const std::vector<Feature>& features, PlaceCandidate candidate) {
  RansacOptions options;
  options.least_inliers = kLeastSeedInliers;
  const std::vector<PointPair> seeds = pairs_of(map, features, candidate.matches);
  const std::optional<RigidMatch> seed = match_rigidly(seeds, map.camera, options);
  if (!seed) return std::nullopt;

  std::vector<LandmarkMatch> guided = match_projected(map, landmarks_of(map, candidate.keyframes), features, seed->world_from_camera);
  const std::vector<PointPair> pairs = pairs_of(map, features, guided);
  const std::optional<RigidMatch> match = refine_rigidly(pairs, map.camera, seed->world_from_camera, kLeastPlaceInliers);
  if (!match) return std::nullopt;

  PlaceMatch place;
  for (const std::uint32_t inlier : match->inliers) place.matches.push_back(guided[inlier]);
  place.keyframe = most_shared(map, candidate.keyframes, place.matches);
  place.submap = map.keyframes[place.keyframe].submap;
  place.submap_from_camera = inverse(map.world_from_submap[place.submap]) * match->world_from_camera;
  return place;
}

bool same_place(const SparseMap& map, const PlaceMatch& a, const PlaceMatch& b) {
  const Rigid3 a_from_b =
      inverse(map.world_from_submap[a.submap] * a.submap_from_camera) * (map.world_from_submap[b.submap] * b.submap_from_camera);
  return a_from_b.translation.norm() <= kSamePlace_m && angle_rad(a_from_b.rotation) <= kSamePlace_rad;
}

}  // namespace

std::vector<PlaceMatch> recognise(const SparseMap& map, const PlaceIndex& index, const std::vector<Feature>& features,
                                  const std::vector<std::uint32_t>& excluded) {
  std::vector<PlaceMatch> found;
  for (PlaceCandidate& candidate : index.query(features, map, excluded))
    if (auto place = verify(map, features, std::move(candidate))) found.push_back(*std::move(place));
  std::stable_sort(found.begin(), found.end(),
                   [](const PlaceMatch& a, const PlaceMatch& b) { return a.matches.size() > b.matches.size(); });
  std::vector<PlaceMatch> places;
  for (PlaceMatch& match : found)
    if (std::none_of(places.begin(), places.end(), [&](const PlaceMatch& better) { return same_place(map, better, match); }))
      places.push_back(std::move(match));
  return places;
}

}  // namespace hermite
