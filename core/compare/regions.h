// Changed places joined to regions. Pure functions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/compare/changes.h"

namespace hermite::compare {

enum class RegionKind : std::uint8_t {
  kAdded,    // the second scan has a surface where the first one looked through
  kRemoved,  // the second scan looked through a surface of the first one
  // A surface of the first scan that lies farther in front in the second, as seen by the camera.
  kMovedTowards,
  kMovedAway,  // or farther behind
};
const char* name_of(RegionKind kind);  // "added", ...

struct ChangedRegion {
  RegionKind kind = RegionKind::kAdded;
  double area_m2 = 0;
  std::size_t place_count = 0;
  // For moved regions: mean signed distance, weighted by area; its standard deviation, in which
  // drift and registration do not average out; and the distance of the place that moved most. 0 for
  // added and removed ones.
  double mean_distance_m = 0, sigma_m = 0, farthest_m = 0;
  // Bounding box in the first scan's world.
  Eigen::Vector3d low_m = Eigen::Vector3d::Zero(), high_m = Eigen::Vector3d::Zero();
  std::vector<std::uint32_t> places;  // ascending
};

// Joins places of the same state that are within two spacings of each other. `is_first`: the
// surface is the first scan's, whose gone places were removed; otherwise only gone places count,
// which were added. Regions whose certain places have less than the least area are dropped, and
// moved ones whose mean distance is below nine tenths of the least change. The others are sorted by
// descending area.
std::vector<ChangedRegion> changed_regions(const ComparedSurface& surface, bool is_first,
                                           const ChangeOptions& options);

}  // namespace hermite::compare
