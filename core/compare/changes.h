// What became of each place of a scan's surface in another scan: the same, nearer, farther, gone or
// not seen. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/compare/alignment.h"
#include "core/compare/compare_progress.h"
#include "core/compare/compared_scan.h"
#include "core/compare/sheet_distance.h"
#include "core/compare/sight.h"

namespace hermite::compare {

// A change below 10 mm is not reported: surfels are rounded off by some millimetres at edges and
// drift by a millimetre (tests/accuracy/README.md, "Mesh"), and three standard deviations of all
// errors must be exceeded, too.
struct ChangeOptions {
  double least_change_m = 0.010;
  double least_deviations = 3;
  double least_area_m2 = 0.003;  // of a region; smaller ones are dropped
};
inline constexpr double kLeastChange_m = 0.001, kMostChange_m = 0.09;
inline constexpr double kLeastDeviations = 1, kMostDeviations = 20;
inline constexpr double kMostRegionArea_m2 = 10;
// kInvalidArgument, naming the option and the limits.
Status validate(const ChangeOptions& options);

enum class PlaceState : std::uint8_t {
  // The other scan has no surface there and has not looked there; or either surface is too broken
  // to be measured.
  kUnseen,
  kSame,     // measured, and not far enough from the other scan's surface to count
  kTowards,  // the other scan's surface lies in front of it, as seen by the camera
  kAway,     // it lies behind
  kGone,     // the other scan looked through it
};

struct ComparedPlace {
  SurfaceSample sample;
  PlaceState state = PlaceState::kUnseen;
  // Signed, along the normal, of the other surface, and its standard deviation: of both surfaces'
  // noise, the registration and the scans' drift. Only if the other surface was found.
  std::optional<double> distance_m;
  double sigma_m = 0;
  // Whether the change is certain by itself: it has the least number of standard deviations, or
  // something is gone. Else the place counts only with certain ones beside it (regions.h).
  bool is_certain = false;
  double area_m2 = 0;  // that the sample stands for
};

struct ComparedSurface {
  std::vector<ComparedPlace> places;
  std::vector<std::uint32_t> of_surfel;  // the place of each surfel of the scan
  double spacing_m = 0;                  // of the places
};

// A scan whose surface is compared with another one; both are in the same world. References to the
// caller's values.
struct ComparedWith {
  const ComparedScan& own;
  const ComparedScan& other;
  const Sight& other_sight;
};

// Compares the surface of the own scan with the other, in the world in which `alignment` was
// estimated. Uses all processors; takes some 100 µs for each place.
ComparedSurface compared_surface(const ComparedWith& scans, const ScanAlignment& alignment,
                                 const ChangeOptions& options,
                                 const CompareProgress& progress = {});

}  // namespace hermite::compare
