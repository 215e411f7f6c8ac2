#include "core/compare/sheet_distance.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hermite::compare {

namespace {

using Eigen::Vector3d;

// Surfels of one layer differ by less than this along the normal; fewer than this many are no
// layer.
constexpr double kLayer_m = 0.008;
constexpr std::size_t kLeastOfLayer = 3;

// Offsets along the normal of the surfels around the line, nearest first.
std::vector<double> offsets_along(const measure::MeasuredPlace& from, const ComparedScan& to,
                                  double reach_m) {
  std::vector<double> offsets_m;
  to.for_each_near(
      from.position_m, std::hypot(reach_m, kLineRadius_m), [&](const output::CloudPoint& surfel) {
        const Vector3d offset = surfel.position_m.cast<double>() - from.position_m;
        const double along_m = offset.dot(from.normal);
        if (std::abs(along_m) > reach_m ||
            surfel.normal.cast<double>().dot(from.normal) < kSheetCosine)
          return;
        if ((offset - along_m * from.normal).squaredNorm() <= kLineRadius_m * kLineRadius_m)
          offsets_m.push_back(along_m);
      });
  std::sort(offsets_m.begin(), offsets_m.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  return offsets_m;
}

std::optional<double> nearest_layer_m(const std::vector<double>& offsets_m) {
  for (const double first_m : offsets_m) {
    double sum = 0;
    std::size_t count = 0;
    for (const double offset_m : offsets_m) {
      if (std::abs(offset_m - first_m) > kLayer_m) continue;
      sum += offset_m;
      ++count;
    }
    if (count >= kLeastOfLayer) return sum / static_cast<double>(count);
  }
  return std::nullopt;
}

}  // namespace

std::optional<measure::MeasuredPlace> place_at(const ComparedScan& scan, const Vector3d& point) {
  std::vector<output::CloudPoint> near;
  scan.append_near(point, measure::kFitReach_m, near);
  Result<measure::MeasuredPlace> place = measure::fit_surface_point(near, point);
  if (!place.ok()) return std::nullopt;
  return *std::move(place);
}

std::optional<SheetDistance> sheet_distance(const measure::MeasuredPlace& from,
                                            const ComparedScan& to, double reach_m) {
  const std::optional<double> layer_m = nearest_layer_m(offsets_along(from, to, reach_m));
  if (!layer_m) return std::nullopt;
  std::optional<measure::MeasuredPlace> place =
      place_at(to, from.position_m + *layer_m * from.normal);
  if (!place) return std::nullopt;
  const double cosine = place->normal.dot(from.normal);
  if (cosine < kSheetCosine) return std::nullopt;
  SheetDistance found;
  found.distance_m = place->normal.dot(place->position_m - from.position_m) / cosine;
  if (std::abs(found.distance_m) > reach_m) return std::nullopt;
  found.sigma_m = std::hypot(from.normal_sigma_m, place->normal_sigma_m);
  found.on_surface = *std::move(place);
  return found;
}

double nearest_surfel_m(const Vector3d& point, const ComparedScan& scan, double reach_m) {
  double least2_m2 = reach_m * reach_m;
  scan.for_each_near(point, reach_m, [&](const output::CloudPoint& surfel) {
    least2_m2 = std::min(least2_m2, (surfel.position_m.cast<double>() - point).squaredNorm());
  });
  return std::sqrt(least2_m2);
}

}  // namespace hermite::compare
