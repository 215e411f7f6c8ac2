// The plane that somebody has pointed at: a wall, a table's top or a door, as far as surfels go on in it from the place that is meant, and
// how well it is known. Pure functions.
//
// The plane grows from the place: at each of some reaches, doubled from one to the next, the surfels that lie near the plane found so far
// and face as it does are laid out on it in cells of 5 cm; those of cells that are connected with the place's give the next one. How well
// it is known is told by the means of the cells about the plane, which show bent walls and noise that neighbours share; single surfels
// would not. The factors were measured (tests/accuracy/README.md, "Measuring").
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "core/base/result.h"
#include "core/measure/surface_fit.h"

namespace hermite {

// Surfels farther than that from the place say nothing about its plane, nor do those that lie so far above or below it.
inline constexpr double kPlaneReach_m = 1.0, kPlaneBand_m = 0.1;

struct MeasuredPlane {
  MeasuredPlace place;                                 // the one that was meant, on the plane, with its normal
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  // of the surfels
  std::array<Eigen::Vector3d, 2> axes;                 // unit, in the plane: along which the surfels reach farthest, and across that
  std::array<double, 2> slope_sigma{};                 // standard deviations of the plane's slope along these
  double height_sigma_m = 0;                           // of the plane at `centre_m`
  std::array<double, 2> spread_m{};                    // standard deviations of the surfels along the axes
  double unevenness_m = 0;                             // of the cells' means about the plane
  int cell_count = 0;                                  // of 5 cm, with surfels of it

  // Standard deviation of the plane along its normal at any point of it.
  double sigma_at_m(const Eigen::Vector3d& point) const;
};

// Whether a surfel may belong to the plane at a place: what fit_plane needs of all those of a result.
bool may_be_of_plane(const CloudPoint& point, const MeasuredPlace& place);

// `place` comes of fit_surface_point; of `points`, in any order, what may_be_of_plane says no to is not looked at. With `one_submap` the
// surfels of others are left out, too: of a map in parts. kNotFound, in words: no plane there that is large enough, or a surface that
// bends or has steps.
Result<MeasuredPlane> fit_plane(std::span<const CloudPoint> points, const MeasuredPlace& place, bool one_submap);

}  // namespace hermite
