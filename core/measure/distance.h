// How far two places of a result are apart, and how well that is known. Pure functions.
//
// The error of a distance is that of its two ends along the line between them (surface_fit.h), and that of the poses from which they were
// seen: some share of the distance, since what every frame has too small the map has too small, and what the camera has drifted on the way
// between them. All are taken for independent and Gaussian; the interval is 1.96 standard deviations to either side. The factors were
// measured (tests/accuracy/README.md, "Measuring"), with the camera that a recording says it has: a focal length that is wrong by 1 % makes
// lengths wrong by as much, and nothing in a scan shows the scale of the world.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "core/measure/camera_way.h"
#include "core/measure/surface_fit.h"

namespace hermite {

// What is known of a result beside its surfels.
struct MapKnowledge {
  CameraWay way;
  std::int64_t part_count = 1;        // of the map, whose places relative to each other nobody knows
  bool camera_was_corrected = false;  // it is then known as well as camera_watch.h says
};

struct Distance {
  double distance_m = 0;
  double half_width_m = 0;                       // of the interval that has the true one in 95 % of all cases
  double surface_sigma_m = 0, pose_sigma_m = 0;  // standard deviations that it is made of
  double way_m = 0;                              // CameraWay::between_m
};

// Nearer to each other two places are one.
inline constexpr double kLeastDistance_m = 0.005;

// kInvalidArgument, in words: both are one place; they lie in different parts of the map; no camera of the path can have seen one of them.
Result<Distance> distance_between(const MeasuredPlace& from, const MeasuredPlace& to, const MapKnowledge& map);

// "1.234 m ± 0.003 m (95 %)": in millimetres, the half-width rounded up.
std::string words_of(const Distance& distance);

}  // namespace hermite
