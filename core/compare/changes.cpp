#include "core/compare/changes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/printf_text.h"

namespace hermite::compare {

namespace {

using Eigen::Vector3d;

constexpr double kPlaceSpacing_m = 0.02;
constexpr std::size_t kMostPlaces = 2'000'000;
// What is gone has no surface of the other scan this near, on any side, and that scan saw something
// this far behind it.
constexpr double kNothingWithin_m = 0.02, kBehind_m = 0.03;
// Of a surface that moved by just the least change, noise leaves half of the places below it. So a
// place counts from this share of the least change on, and its region must reach the least change
// on average (regions.h).
constexpr double kPlaceShare = 0.75;
// A place with this share of the least number of standard deviations counts beside certain ones.
constexpr double kUncertainShare = 0.5;
// A surface that changed has nothing of the other scan within this share of the least change, on
// any side.
constexpr double kClearShare = 0.5;

struct Comparing {
  const ComparedScan& own;
  const ComparedScan& other;
  const Sight& other_sight;
  const ScanAlignment& alignment;
  const ChangeOptions& options;
};

// Standard deviation along a normal of what the registration and the scans' drift add.
double placing_sigma_m(const ScanAlignment& alignment, const measure::MeasuredPlace& place) {
  Vector6d gradient;
  gradient << place.normal, place.position_m.cross(place.normal);
  return std::hypot(std::sqrt(std::max(0.0, gradient.dot(alignment.covariance * gradient))),
                    alignment.disagreement_m);
}

void measure_place(const Comparing& comparing, ComparedPlace& place) {
  const std::optional<measure::MeasuredPlace> own =
      place_at(comparing.own, place.sample.position_m);
  if (!own || own->normal.dot(place.sample.normal) < kSheetCosine) return;
  const std::optional<SheetDistance> found = sheet_distance(*own, comparing.other, kSheetReach_m);
  const double placing_m = placing_sigma_m(comparing.alignment, *own);
  if (!found) {
    const bool is_clear = nearest_surfel_m(place.sample.position_m, comparing.other,
                                           kNothingWithin_m) >= kNothingWithin_m;
    if (is_clear && comparing.other_sight.looked_through(place.sample.position_m, kBehind_m)) {
      place.state = PlaceState::kGone;
      place.is_certain = true;
    }
    return;
  }
  place.distance_m = found->distance_m;
  place.sigma_m = std::hypot(found->sigma_m, placing_m);
  const double size_m = std::abs(found->distance_m),
               deviations_m = comparing.options.least_deviations * place.sigma_m;
  const double clear_m = kClearShare * comparing.options.least_change_m;
  const bool has_changed =
      size_m > kPlaceShare * comparing.options.least_change_m &&
      size_m > kUncertainShare * deviations_m &&
      nearest_surfel_m(place.sample.position_m, comparing.other, clear_m) >= clear_m;
  place.is_certain = has_changed && size_m > deviations_m;
  place.state = !has_changed            ? PlaceState::kSame
                : found->distance_m > 0 ? PlaceState::kTowards
                                        : PlaceState::kAway;
}

}  // namespace

Status validate(const ChangeOptions& options) {
  const auto error = [](const char* name, double value, double low, double high) {
    return Error{ErrorCode::kInvalidArgument,
                 printf_text("%s is %g, allowed are %g to %g", name, value, low, high)};
  };
  if (!(options.least_change_m >= kLeastChange_m && options.least_change_m <= kMostChange_m))
    return error("the least change [m]", options.least_change_m, kLeastChange_m, kMostChange_m);
  if (!(options.least_deviations >= kLeastDeviations &&
        options.least_deviations <= kMostDeviations))
    return error("the number of standard deviations", options.least_deviations, kLeastDeviations,
                 kMostDeviations);
  if (!(options.least_area_m2 >= 0 && options.least_area_m2 <= kMostRegionArea_m2))
    return error("the least area of a region [m^2]", options.least_area_m2, 0, kMostRegionArea_m2);
  return Done{};
}

ComparedSurface compared_surface(const ComparedWith& scans, const ScanAlignment& alignment,
                                 const ChangeOptions& options, const CompareProgress& progress) {
  SurfaceSamples samples = surface_samples(scans.own.surfels(), kPlaceSpacing_m, kMostPlaces);
  ComparedSurface surface;
  surface.spacing_m = samples.spacing_m;
  surface.of_surfel = std::move(samples.of_surfel);
  surface.places.resize(samples.samples.size());
  const Comparing comparing{scans.own, scans.other, scans.other_sight, alignment, options};
  constexpr std::size_t kToldEvery = 512;  // places, some 50 ms
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> stopped = false;
  in_parallel(surface.places.size(), [&](std::size_t i) {
    if (stopped) return;
    if (const std::size_t count = ++done; count % kToldEvery == 0)
      stopped = !goes_on(progress,
                         static_cast<double>(count) / static_cast<double>(surface.places.size()));
    ComparedPlace& place = surface.places[i];
    place.sample = samples.samples[i];
    // A plane meets this many cubes: its area over the square of a cube's side, times the sum of
    // the normal's components.
    place.area_m2 = surface.spacing_m * surface.spacing_m / place.sample.normal.cwiseAbs().sum();
    measure_place(comparing, place);
  });
  return surface;
}

}  // namespace hermite::compare
