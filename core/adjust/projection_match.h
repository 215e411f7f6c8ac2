// Which landmarks the features of an image are, when the camera's pose is known to some pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/sparse_map.h"

namespace hermite {

struct LandmarkMatch {
  std::uint32_t feature = 0;
  std::uint32_t landmark = 0;
  int distance = 0;  // bits between their descriptors
  bool operator==(const LandmarkMatch&) const = default;
};

// Of these the nearest descriptors first, each feature and each landmark once; ascending features.
std::vector<LandmarkMatch> one_to_one(std::vector<LandmarkMatch> matches);

struct ProjectionOptions {
  // Around the projected landmark, at octave 0; times 1.2^octave for the others, whose pixels are larger. The authors' number: the dense
  // pose is good for 1 or 2 px, colour and depth of a Kinect are misaligned by a few more.
  double radius_px = 7;
  int max_distance = 64;   // bits; of matches beyond, as many are wrong as right within that radius
  double max_ratio = 0.8;  // of the best distance to the second best of the same octave within the radius
};

// Of each landmark the feature within the radius whose descriptor is nearest, if
//   its octave is at most one off what the distance to the landmark asks for,
//   it is turned like the feature that saw the landmark last, give or take 30 degrees,
//   its depth, where it has one, is the landmark's within three standard deviations or 3 cm (drift between submaps that no correction has
//   seen yet is of centimetres; another surface is usually farther),
//   the landmark was seen last from within 60 degrees of this direction (corners do not look alike from farther round).
// Every feature and every landmark at most once, the nearest descriptors first. Landmarks without observations are passed over. Ascending
// features.
std::vector<LandmarkMatch> match_projected(const SparseMap& map, const std::vector<std::uint32_t>& landmarks,
                                           const std::vector<Feature>& features, const Rigid3& world_from_camera,
                                           const ProjectionOptions& options = {});

}  // namespace hermite
