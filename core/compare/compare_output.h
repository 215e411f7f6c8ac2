// The files of a comparison. Pure functions; the same comparison gives the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/compare/compare.h"

namespace hermite::compare {

// report.json: verdict and words; a_from_b as 4x4 matrix, its covariance and figures of the
// registration; areas; and the regions with kind, area_m2, mean_distance_m, sigma_m, box. Metres,
// in the first scan's world.
std::string format_comparison_json(const Comparison& comparison, const ChangeOptions& options);

// changes.ply, binary: the first scan's surfels and the added ones of the second, each with
// position, normal, colour, `distance` (signed, of the other surface; NaN if there is none),
// `sigma` [m] and `region` (-1: none; otherwise the index in the report). Within regions, colours
// show the change: red towards the camera and blue away from it, full at 5 cm; magenta removed,
// green added. Elsewhere surfels are grey, and darker where the second scan has not looked.
std::string format_changes_ply(const Comparison& comparison);

// What a place of a scan's surface is called in `state` of the points below.
enum class PointState : std::uint8_t {
  kUnseen = 0,   // the other scan has not seen it, or it could not be measured
  kSame = 1,     // within its uncertainty, or too small to be reported
  kMoved = 2,    // in a region that moved: `distance` is significant
  kRemoved = 3,  // of the first scan: in a region that the second looked through
  kAdded = 4,    // of the second scan: in a region that the first looked through
};

// At most this many points of each scan are written, thinned out evenly.
inline constexpr std::size_t kMostShownPoints = 400'000;

// points.ply, binary: both scans in the first one's world, to be shown in colours of one's choice.
// Per point: float x y z, nx ny nz, uchar red green blue (its own colour), float distance (signed,
// of the other scan's surface along the normal; NaN if there is none), float sigma (of the
// distance), uchar state (PointState), uchar scan (0: the first, 1: the second), int region (-1:
// none; otherwise the index in the report). Only with the verdict kSamePlace.
std::string format_compared_points_ply(const Comparison& comparison);

}  // namespace hermite::compare
