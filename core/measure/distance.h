// How far two places of a result are apart, straight or along the vertical, and how well that is known. Pure functions.
//
// The error of a distance is that of its two ends along the direction in which it is measured (surface_fit.h), and that of the poses from
// which they were seen (pose_error.h). All are taken for independent and Gaussian. The factors were measured (tests/accuracy/README.md,
// "Measuring"), with the camera that a recording says it has: a focal length that is wrong by 1 % makes lengths wrong by as much, and
// nothing in a scan shows the scale of the world.
#pragma once

#include <Eigen/Core>

#include "core/base/result.h"
#include "core/measure/pose_error.h"
#include "core/measure/quantity.h"

namespace hermite {

// Nearer to each other two places are one.
inline constexpr double kLeastDistance_m = 0.005;

// kInvalidArgument, in words: both are one place; pose_error_of.
Result<Quantity> distance_between(const MeasuredPlace& from, const MeasuredPlace& to, const MapKnowledge& map);

// What the direction that was found to be up in a scan is off by, about each axis across it: 7 and 15 mrad in all, in two rooms.
inline constexpr double kUpSigma_rad = 0.008;

// How much higher one lies than the other, whichever it is. `up` is a unit vector; that it was found in the scan, and is off by half a
// degree, is in the interval, by how far the places are apart across it. Errors as above.
Result<Quantity> height_between(const MeasuredPlace& from, const MeasuredPlace& to, const Eigen::Vector3d& up, const MapKnowledge& map);

}  // namespace hermite
