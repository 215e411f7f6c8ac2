// The place on a surface that somebody has pointed at: a plane through the surfels around it, in which the noise of single surfels averages
// out, and how well it is known. Pure functions.
//
// What a surfel is off by has two parts. Its noise shows as the spread about the plane. Where the surface bends sharply or ends, surfels
// are rounded off by up to some millimetres, all to the same side, which no spread shows; but their normals turn away from the plane's
// there. So the standard deviation is made of both, with factors that were measured (tests/accuracy/README.md, "Measuring").
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

// Surfels farther than that from a pick say nothing about it.
inline constexpr double kFitReach_m = 0.06;

struct MeasuredPlace {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // in the world of the scan, on the plane, straight below the pick
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();      // unit, towards the camera that saw it
  double normal_sigma_m = 0;                             // standard deviation of the place along its normal
  double noise_m = 0, bend_m = 0;  // what that is made of: error of the plane's height by the spread, and by bent surface
  std::uint32_t submap = 0;        // of the surfel nearest to the pick
};

// `points` are those of a result that lie around `pick`, in any order; what is farther than kFitReach_m is not looked at.
// kInvalidArgument: the pick is not finite. kNotFound, in words: no surface there.
Result<MeasuredPlace> fit_surface_point(std::span<const CloudPoint> points, const Eigen::Vector3d& pick);

}  // namespace hermite
