// The distance between two places of a result, straight or along the vertical, and its uncertainty.
// Pure functions.
//
// The error of a distance consists of the errors of its two ends along the direction of measurement
// (surface_fit.h), and of the poses from which they were seen (pose_error.h). All are assumed to be
// independent and Gaussian. The factors were measured (tests/accuracy/README.md, "Measuring"), with
// the camera parameters that a recording states: a focal length that is wrong by 1 % makes lengths
// wrong by as much, and nothing in a scan shows the scale of the world.
#pragma once

#include <Eigen/Core>

#include "core/base/result.h"
#include "core/measure/pose_error.h"
#include "core/measure/quantity.h"

namespace hermite::measure {

// Two places closer than this are the same place.
inline constexpr double kLeastDistance_m = 0.005;

// Returns the distance; kInvalidArgument when both are the same place, and as for pose_error_of.
Result<Quantity> distance_between(const MeasuredPlace& from, const MeasuredPlace& to,
                                  const MapKnowledge& map);

// Standard deviation of the estimated up direction of a scan about each horizontal axis; the total
// errors in two rooms were 7 and 15 mrad.
inline constexpr double kUpSigma_rad = 0.008;

// Returns the unsigned difference in height. `up` is a unit vector; it was estimated from the scan
// and is off by half a degree, which the interval includes in proportion to the horizontal distance
// of the places. Errors as above.
Result<Quantity> height_between(const MeasuredPlace& from, const MeasuredPlace& to,
                                const Eigen::Vector3d& up, const MapKnowledge& map);

}  // namespace hermite::measure
