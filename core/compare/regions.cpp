#include "core/compare/regions.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/disjoint_sets.h"
#include "core/compare/sample_grid.h"

namespace hermite::compare {

namespace {

constexpr double kJoinSpacings = 2;
// The drift of both scans, about a millimetre, must not hide what moved by just the least change.
constexpr double kMeanShare = 0.9;

bool counts(PlaceState state, bool is_first) {
  if (state == PlaceState::kGone) return true;
  return is_first && (state == PlaceState::kTowards || state == PlaceState::kAway);
}

RegionKind kind_of(PlaceState state, bool is_first) {
  if (state == PlaceState::kTowards) return RegionKind::kMovedTowards;
  if (state == PlaceState::kAway) return RegionKind::kMovedAway;
  return is_first ? RegionKind::kRemoved : RegionKind::kAdded;
}

ChangedRegion region_of(const ComparedSurface& surface, std::vector<std::uint32_t> members,
                        bool is_first) {
  ChangedRegion region;
  region.kind = kind_of(surface.places[members.front()].state, is_first);
  region.low_m = region.high_m = surface.places[members.front()].sample.position_m;
  double weighted_variance = 0;
  for (const std::uint32_t member : members) {
    const ComparedPlace& place = surface.places[member];
    region.area_m2 += place.area_m2;
    region.low_m = region.low_m.cwiseMin(place.sample.position_m);
    region.high_m = region.high_m.cwiseMax(place.sample.position_m);
    if (place.state == PlaceState::kGone || !place.distance_m) continue;
    region.mean_distance_m += place.area_m2 * *place.distance_m;
    weighted_variance += place.area_m2 * place.sigma_m * place.sigma_m;
    if (std::abs(*place.distance_m) > std::abs(region.farthest_m))
      region.farthest_m = *place.distance_m;
  }
  region.mean_distance_m /= region.area_m2;
  // The errors of neighbouring places have most in common: their mean is not better than one of
  // them.
  region.sigma_m = std::sqrt(weighted_variance / region.area_m2);
  region.place_count = members.size();
  region.places = std::move(members);
  return region;
}

bool is_large_enough(const ChangedRegion& region, const ComparedSurface& surface,
                     const ChangeOptions& options) {
  double certain_m2 = 0;
  for (const std::uint32_t place : region.places)
    certain_m2 += surface.places[place].is_certain ? surface.places[place].area_m2 : 0;
  if (certain_m2 == 0 || certain_m2 < options.least_area_m2) return false;
  const bool has_moved =
      region.kind == RegionKind::kMovedTowards || region.kind == RegionKind::kMovedAway;
  return !has_moved || std::abs(region.mean_distance_m) >= kMeanShare * options.least_change_m;
}

}  // namespace

const char* name_of(RegionKind kind) {
  switch (kind) {
    case RegionKind::kAdded: return "added";
    case RegionKind::kRemoved: return "removed";
    case RegionKind::kMovedTowards: return "moved_towards";
    case RegionKind::kMovedAway: return "moved_away";
  }
  return "";
}

std::vector<ChangedRegion> changed_regions(const ComparedSurface& surface, bool is_first,
                                           const ChangeOptions& options) {
  std::vector<std::uint32_t> changed;
  std::vector<SurfaceSample> samples;
  for (std::uint32_t i = 0; i < surface.places.size(); ++i) {
    if (!counts(surface.places[i].state, is_first)) continue;
    changed.push_back(i);
    samples.push_back(surface.places[i].sample);
  }
  const double reach_m = kJoinSpacings * surface.spacing_m;
  const SampleGrid grid(samples, reach_m);
  DisjointSets sets(changed.size());
  for (std::uint32_t i = 0; i < changed.size(); ++i)
    grid.for_each_within(samples[i].position_m, reach_m, [&](std::uint32_t j) {
      if (j < i && surface.places[changed[i]].state == surface.places[changed[j]].state)
        sets.join(i, j);
    });
  std::map<std::uint32_t, std::vector<std::uint32_t>> members;
  for (std::uint32_t i = 0; i < changed.size(); ++i) members[sets.root(i)].push_back(changed[i]);
  std::vector<ChangedRegion> regions;
  for (auto& [root, places] : members) {
    ChangedRegion region = region_of(surface, std::move(places), is_first);
    if (is_large_enough(region, surface, options)) regions.push_back(std::move(region));
  }
  std::stable_sort(
      regions.begin(), regions.end(),
      [](const ChangedRegion& x, const ChangedRegion& y) { return x.area_m2 > y.area_m2; });
  return regions;
}

}  // namespace hermite::compare
