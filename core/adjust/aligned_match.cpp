#include "core/adjust/aligned_match.h"

namespace hermite::adjust {
namespace {

// Correct matches are off by one pixel of their octave, seldom by two. Within three pixels, a match
// is correct or a neighbour that does no harm.
constexpr double kCloseRadius_px = 3;
// Within the close radius, half of the matches with a larger Hamming distance are wrong.
constexpr int kMaxCloseDistance = 80;

}  // namespace

std::vector<PointPair> point_pairs(const SparseMap& map, const std::vector<Feature>& features,
                                   std::vector<LandmarkMatch>& matches) {
  std::erase_if(matches,
                [&](const LandmarkMatch& match) { return features[match.feature].depth_m <= 0; });
  std::vector<PointPair> pairs;
  pairs.reserve(matches.size());
  for (const LandmarkMatch& match : matches) {
    const Feature& feature = features[match.feature];
    const Landmark& landmark = map.landmarks[match.landmark];
    pairs.push_back(
        {map.camera.unproject(feature.pixel_px.x(), feature.pixel_px.y(), feature.depth_m),
         position_in_world_m(map, landmark), octave_scale(feature.octave),
         position_sigma_m(map, landmark)});
  }
  return pairs;
}

AlignedMatches match_aligned(const SparseMap& map, const std::vector<std::uint32_t>& landmarks,
                             const std::vector<Feature>& features,
                             const Rigid3& world_from_camera_guess, double radius_px) {
  ProjectionOptions options;
  options.radius_px = radius_px;
  std::vector<LandmarkMatch> wide =
      match_projected(map, landmarks, features, world_from_camera_guess, options);
  const std::vector<PointPair> pairs = point_pairs(map, features, wide);
  const std::optional<RigidMatch> common =
      refine_rigidly(pairs, map.camera, world_from_camera_guess, kLeastAlignedInliers);
  AlignedMatches aligned{common ? common->world_from_camera : world_from_camera_guess, {}};
  options.radius_px = kCloseRadius_px;
  options.max_distance = kMaxCloseDistance;
  aligned.matches = match_projected(map, landmarks, features, aligned.world_from_camera, options);
  return aligned;
}

}  // namespace hermite::adjust
