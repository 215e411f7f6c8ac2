// Matching by projection when the guess of the pose is off by some pixels: once widely, then closely around the pose that the first matches
// have in common.
#pragma once

#include <vector>

#include "core/adjust/projection_match.h"
#include "core/adjust/rigid_ransac.h"
#include "core/adjust/sparse_map.h"

namespace hermite {

// Pairs of the matches whose feature has depth; the other matches are taken out of `matches`.
std::vector<PointPair> point_pairs(const SparseMap& map, const std::vector<Feature>& features, std::vector<LandmarkMatch>& matches);

struct AlignedMatches {
  Rigid3 world_from_camera;            // the guess when fewer than kLeastAlignedInliers matches agree on a better pose
  std::vector<LandmarkMatch> matches;  // as match_projected has them
};

// Measured on rendered rooms with Kinect noise and 3 mm, 0.2 degrees of error in the guess: against one pass of 7 px and 100 bits as many
// right matches, and 3.5 to 7 % wrong ones in place of 17 to 27 %. `radius_px` is that of the first pass.
inline constexpr std::size_t kLeastAlignedInliers = 15;
AlignedMatches match_aligned(const SparseMap& map, const std::vector<std::uint32_t>& landmarks, const std::vector<Feature>& features,
                             const Rigid3& world_from_camera_guess, double radius_px = ProjectionOptions{}.radius_px);

}  // namespace hermite
