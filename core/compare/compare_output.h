// The files of a comparison. Pure functions; the same comparison gives the same bytes.
#pragma once

#include <string>

#include "core/compare/compare.h"

namespace hermite {

// report.json: verdict and words; a_from_b as 4x4 matrix, its covariance and figures of the registration; areas; and the
// regions with kind, area_m2, mean_distance_m, sigma_m, box. Metres, in the first scan's world.
std::string format_comparison_json(const Comparison& comparison, const ChangeOptions& options);

// changes.ply, binary: the first scan's surfels and the added ones of the second, each with position, normal, colour,
// `distance` (signed, of the other surface; NaN if there is none), `sigma` [m] and `region` (-1: none; otherwise the
// index in the report). Within regions, colours show the change: red towards the camera and blue away from it, full at
// 5 cm; magenta removed, green added. Elsewhere surfels are grey, and darker where the second scan has not looked.
std::string format_changes_ply(const Comparison& comparison);

}  // namespace hermite
