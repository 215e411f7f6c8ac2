// The place on a surface at which a user has pointed: a plane through the surfels around it, in
// which the noise of single surfels averages out, and its uncertainty. Pure functions.
//
// The error of surfels has two parts. Noise shows as their spread about the plane. Where the
// surface bends sharply or ends, surfels are rounded off by up to some millimetres, all to the same
// side, which the spread does not show; but their normals differ from the plane's there. So the
// standard deviation is computed from both, with factors that were measured
// (tests/accuracy/README.md, "Measuring").
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite::measure {

// Surfels farther than this from a pick are ignored.
inline constexpr double kFitReach_m = 0.06;

struct MeasuredPlace {
  // In the world of the scan: the projection of the pick onto the plane.
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, towards the camera that saw it
  // Standard deviation of the place along its normal.
  double normal_sigma_m = 0;
  // Parts of it: error of the plane's height by the spread, and by bent surface.
  double noise_m = 0, bend_m = 0;
  std::uint32_t submap = 0;  // that of the surfel nearest to the pick
};

// `points` are those of a result around `pick`, in any order; those farther than kFitReach_m are
// ignored. kInvalidArgument when the pick is not finite; kNotFound when there is no surface.
Result<MeasuredPlace> fit_surface_point(std::span<const output::CloudPoint> points,
                                        const Eigen::Vector3d& pick);

}  // namespace hermite::measure
