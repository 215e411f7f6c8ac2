// Where in the map an image was taken, without a guess: for loops and for a lost camera. What it returns fits the landmarks geometrically;
// identical rooms do so too, hence the runner-up, and the caller checks the dense surface before it believes a place.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/place_index.h"
#include "core/adjust/projection_match.h"
#include "core/adjust/sparse_map.h"

namespace hermite {

struct PlaceMatch {
  std::uint32_t keyframe = 0;  // the map's that shares most matches with the image
  std::uint32_t submap = 0;    // that keyframe's
  Rigid3 submap_from_camera;
  std::vector<LandmarkMatch> matches;  // the inliers, ascending features, all with depth
};

// By descending number of inliers, each at least kLeastPlaceInliers. Poses within 0.5 m and 30 degrees of each other in the world are one
// place, of which the better is listed; the second entry is therefore the best place elsewhere. `excluded` keyframes are not looked at: for
// a loop those of the last seconds. Deterministic. Thread-safe.
//
// Measured: images of other scenes get at most 4 inliers, right places 30 to 700, fewer where little overlaps. But two equal sofas got up
// to 47, in rooms where the true place was not in the map: there is no runner-up then, and only the dense surface tells. Submaps that have
// drifted apart and show the same place are listed as two places until a correction has joined them.
inline constexpr std::size_t kLeastPlaceInliers = 15;
std::vector<PlaceMatch> recognise(const SparseMap& map, const PlaceIndex& index, const std::vector<Feature>& features,
                                  const std::vector<std::uint32_t>& excluded = {});

}  // namespace hermite
