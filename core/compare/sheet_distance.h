// The distance from a place of one scan to the surface of another one, along the place's normal.
// Pure functions.
//
// This is the M3C2 distance of Lague, Brodu, Leroux, "Accurate 3D comparison of complex topography
// with terrestrial laser scanner", ISPRS Journal 82 (2013), doi 10.1016/j.isprsjprs.2013.04.009,
// with two changes. The surfaces are planes fitted to surfels (core/measure/surface_fit.h), whose
// calibrated standard deviations replace those of a mean. And of several layers of surface along
// the normal, the nearest counts instead of the mean of all.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/compare/compared_scan.h"
#include "core/measure/surface_fit.h"

namespace hermite::compare {

// Surfels belong to the line along a normal if they are this near to it, and if their normals are
// this similar (cosine).
inline constexpr double kLineRadius_m = 0.02, kSheetCosine = 0.6;
// Farther surfaces are other surfaces.
inline constexpr double kSheetReach_m = 0.1;

struct SheetDistance {
  // Positive: the other surface lies on the side towards which the place's normal points.
  double distance_m = 0;
  measure::MeasuredPlace on_surface;  // of the other scan
  double sigma_m = 0;                 // of both places
};

// Returns the place of the scan's surface at a point near it; nullopt if the surface is too broken
// there.
std::optional<measure::MeasuredPlace> place_at(const ComparedScan& scan,
                                               const Eigen::Vector3d& point);

// Returns the distance to the nearest layer within `reach_m` along the normal; nullopt if there is
// none.
std::optional<SheetDistance> sheet_distance(const measure::MeasuredPlace& from,
                                            const ComparedScan& to, double reach_m);

// Returns the distance from a point to the nearest surfel, whatever its normal; `reach_m` if none
// is nearer.
double nearest_surfel_m(const Eigen::Vector3d& point, const ComparedScan& scan, double reach_m);

}  // namespace hermite::compare
