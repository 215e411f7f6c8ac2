// Compares two finished scans of a place: where the second lies in the first one, and what has
// changed between them. Pure function.
#pragma once

#include <string>
#include <vector>

#include "core/compare/changes.h"
#include "core/compare/regions.h"
#include "core/compare/register.h"

namespace hermite::compare {

struct Comparison {
  Registration registration;
  // Only with the verdict kSamePlace; all in the first scan's world. The second scan's surface is
  // moved there.
  ComparedSurface surface_a, surface_b;
  output::Cloud surfels_a, surfels_b;
  // Regions of both, first those of `surface_a`, each by descending area.
  std::vector<ChangedRegion> regions;
  // How many are of `surface_a`; the rest, the added ones, is of `surface_b`.
  std::size_t regions_of_a = 0;
  double compared_area_m2 = 0;  // of the first scan's surface: measured or looked through
  double unseen_area_m2 = 0;    // of the first scan's surface: not seen by the second
  // Of the scans' maps. How the parts of one lie to each other is unknown, and counts as a change.
  std::int64_t parts_of_a = 1, parts_of_b = 1;
  // Whether the scans' paths are known: without them nothing is called added (A), removed (B).
  bool sees_a = false, sees_b = false;
};

// kInvalidArgument for options out of range; kBusy: stopped. That two scans do not show the same
// place is no error, but a verdict. Deterministic; uses all processors, for about 10 s in a room,
// and 1 KB of memory for each surfel.
Result<Comparison> compare_scans(const ComparedScan& a, const ComparedScan& b,
                                 const ChangeOptions& options,
                                 const CompareProgress& progress = {});

}  // namespace hermite::compare
