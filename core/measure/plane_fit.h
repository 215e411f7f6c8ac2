// The plane at which a user has pointed, such as a wall, a table top or a door, as far as its
// surfels extend from the place, and its uncertainty. Pure functions.
//
// The plane grows from the place in several steps, each with about twice the reach of the last. In
// each step, the surfels near the present plane that face the same way are sorted into cells of 5
// cm on it, and those of cells connected with the place define the next plane. Its uncertainty is
// computed from the deviations of the cells' means from the plane, which show bent walls and
// correlated noise; single surfels would not. The factors were measured (tests/accuracy/README.md,
// "Measuring").
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "core/base/result.h"
#include "core/measure/surface_fit.h"

namespace hermite::measure {

// Surfels farther than this from the place, or this far above or below its plane, are ignored.
inline constexpr double kPlaneReach_m = 1.0, kPlaneBand_m = 0.1;

// The means of a plane's surfels in cells of this size show noise and bends.
inline constexpr double kPlaneCell_m = 0.05;

struct PlaneErrors {
  // Standard deviations of its height at the centre, and of its slope along one axis.
  double height_sigma_m = 0, slope_sigma = 0;
};

// Returns the errors from the RMS deviation of the cells' means, and the standard deviation of the
// surfels along the axis.
PlaneErrors plane_errors_of(double unevenness_m, double cell_count, double spread_m);

struct MeasuredPlane {
  // The given place, moved onto the plane, with the plane's normal.
  MeasuredPlace place;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  // of the surfels
  // Unit vectors in the plane: the direction of largest extent, and the one perpendicular to it.
  std::array<Eigen::Vector3d, 2> axes;
  std::array<double, 2> slope_sigma{};  // standard deviations of the plane's slope along the axes
  double height_sigma_m = 0;            // of the plane at `centre_m`
  std::array<double, 2> spread_m{};     // standard deviations of the surfels along the axes
  double unevenness_m = 0;              // RMS deviation of the cells' means from the plane
  int cell_count = 0;                   // number of cells of 5 cm with surfels of the plane

  // Returns the standard deviation of the plane along its normal at any point of it.
  double sigma_at_m(const Eigen::Vector3d& point) const;
};

// Returns whether a surfel may belong to the plane at a place; fit_plane needs all of these.
bool may_be_of_plane(const output::CloudPoint& point, const MeasuredPlace& place);

// Fits a plane at a `place` from fit_surface_point. `points` are in any order; those that
// may_be_of_plane rejects are ignored. With `one_submap`, for maps of several components, surfels
// of other submaps are ignored too. kNotFound when there is no large enough plane, or when the
// surface bends or has steps.
Result<MeasuredPlane> fit_plane(std::span<const output::CloudPoint> points,
                                const MeasuredPlace& place, bool one_submap);

}  // namespace hermite::measure
