// Place recognition with geometric verification, without a guess of the pose: for loops and for
// relocalisation. Identical rooms pass the geometric test as well; hence the runner-up is returned,
// and the caller verifies the dense surface before it accepts a place.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/place_index.h"
#include "core/adjust/projection_match.h"
#include "core/adjust/sparse_map.h"

namespace hermite::adjust {

// Poses in the world that are farther apart are at different places.
inline constexpr double kSamePlace_m = 0.5;

struct PlaceMatch {
  std::uint32_t keyframe = 0;  // of the map; shares most matches with the image
  std::uint32_t submap = 0;    // the submap of that keyframe
  Rigid3 submap_from_camera;
  // The inliers, in ascending order of features, all with depth.
  std::vector<LandmarkMatch> matches;
};

// A place needs this many matches that agree on one pose.
inline constexpr std::size_t kLeastPlaceInliers = 15;
// A place is unambiguous if the runner-up has fewer than this share of its inliers: identical rooms
// have nearly as many.
inline constexpr double kAmbiguousShare = 0.7;

// Returns places in descending number of inliers, each with at least kLeastPlaceInliers. Poses
// within kSamePlace_m and 30 degrees of each other in the world are one place, of which the better
// pose is listed, so the second entry is the best place elsewhere. `excluded` keyframes are
// skipped; for a loop these are the ones of the last seconds. Deterministic. Thread-safe.
//
// Measured: images of other scenes get at most 4 inliers, correct places 30 to 700, fewer where the
// overlap is small. But two equal sofas got up to 47, in rooms whose true place was not in the map;
// then there is no runner-up, and only the dense surface can tell. Submaps that have drifted apart
// and show the same place are listed as two places until a correction joins them.
std::vector<PlaceMatch> recognise(const SparseMap& map, const PlaceIndex& index,
                                  const std::vector<Feature>& features,
                                  const std::vector<std::uint32_t>& excluded = {});

}  // namespace hermite::adjust
