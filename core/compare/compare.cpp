#include "core/compare/compare.h"

#include <atomic>
#include <utility>

namespace hermite::compare {

namespace {

void add_areas(Comparison& comparison) {
  for (const ComparedPlace& place : comparison.surface_a.places)
    (place.state == PlaceState::kUnseen ? comparison.unseen_area_m2
                                        : comparison.compared_area_m2) += place.area_m2;
}

// Fractions of the time at which the steps end.
constexpr double kRegistered = 0.6, kFirstCompared = 0.8;

}  // namespace

Result<Comparison> compare_scans(const ComparedScan& a, const ComparedScan& b,
                                 const ChangeOptions& options, const CompareProgress& told) {
  if (const Status status = validate(options); !status.ok()) return status.error();
  std::atomic<bool> stopped = false;
  const CompareProgress progress = [&](double done) {
    if (!stopped && !goes_on(told, done)) stopped = true;
    return !stopped;
  };
  const Error stopped_error{ErrorCode::kBusy, "stopped"};
  const double spacing_m = coarse_spacing_m(a, b);
  const CoarseScan coarse_a(a, spacing_m);
  Comparison comparison;
  comparison.parts_of_a = a.part_count();
  comparison.parts_of_b = b.part_count();
  comparison.sees_a = !a.trajectory().empty();
  comparison.sees_b = !b.trajectory().empty();
  comparison.registration =
      register_scans(coarse_a, CoarseScan(b, spacing_m), part_of(progress, 0, kRegistered));
  if (stopped) return stopped_error;
  if (comparison.registration.verdict != RegistrationVerdict::kSamePlace) return comparison;
  const ScanAlignment& alignment = comparison.registration.alignment;
  Result<ComparedScan> moved =
      ComparedScan::create(moved_cloud(b.surfels(), alignment.a_from_b),
                           moved_trajectory(b.trajectory(), alignment.a_from_b), "the second scan");
  if (!moved.ok()) return moved.error();
  comparison.surface_a = compared_surface({a, *moved, Sight(*moved)}, alignment, options,
                                          part_of(progress, kRegistered, kFirstCompared));
  comparison.surface_b = compared_surface({*moved, a, coarse_a.sight()}, alignment, options,
                                          part_of(progress, kFirstCompared, 1));
  if (stopped) return stopped_error;
  comparison.surfels_a = a.surfels();
  comparison.surfels_b = moved->surfels();
  comparison.regions = changed_regions(comparison.surface_a, true, options);
  comparison.regions_of_a = comparison.regions.size();
  for (ChangedRegion& region : changed_regions(comparison.surface_b, false, options))
    comparison.regions.push_back(std::move(region));
  add_areas(comparison);
  return comparison;
}

}  // namespace hermite::compare
