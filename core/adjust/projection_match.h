// Matching of features with landmarks, given the camera's pose to within some pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/sparse_map.h"

namespace hermite::adjust {

struct LandmarkMatch {
  std::uint32_t feature = 0;
  std::uint32_t landmark = 0;
  int distance = 0;  // Hamming distance of their descriptors [bits]
  bool operator==(const LandmarkMatch&) const = default;
};

// Selects matches with the nearest descriptors first, so that each feature and each landmark occurs
// once. Ordered by feature.
std::vector<LandmarkMatch> one_to_one(std::vector<LandmarkMatch> matches);

struct ProjectionOptions {
  // Search radius around the projected landmark at octave 0, times 1.2^octave for the others, whose
  // pixels are larger. The value is the authors': the dense pose is accurate to 1 or 2 px, and a
  // Kinect's colour and depth are misaligned by a few more.
  double radius_px = 7;
  // [bits]; beyond it, as many matches are wrong as right within that radius.
  int max_distance = 64;
  double max_ratio = 0.8;  // best to second best distance of the same octave within the radius
};

// Matches each landmark with the feature within the radius that has the nearest descriptor, if
//   its octave is at most one off the octave expected at the landmark's distance,
//   its orientation is within 30 degrees of that of the feature that saw the landmark last,
//   its depth, if any, is the landmark's within three standard deviations or 3 cm (drift between
//       submaps that is not yet corrected is of centimetres; another surface is usually farther),
//   and the landmark was last seen from within 60 degrees of this direction (corners look different
//       beyond).
// Every feature and every landmark is used at most once, nearest descriptors first. Landmarks
// without observations are skipped. Ordered by feature.
std::vector<LandmarkMatch> match_projected(const SparseMap& map,
                                           const std::vector<std::uint32_t>& landmarks,
                                           const std::vector<Feature>& features,
                                           const Rigid3& world_from_camera,
                                           const ProjectionOptions& options = {});

}  // namespace hermite::adjust
