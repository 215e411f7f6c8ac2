#include "core/plan/wall_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/measure/plane_fit.h"

namespace hermite::plan {

namespace {

using Eigen::Vector2d;

constexpr double kAboveFloor_m = 0.12;  // above skirting boards
constexpr double kFromCorner_m = 0.05;  // corners are rounded off
constexpr std::size_t kLeastFacets = 50;
// Only a wall that is longer than it is uneven by far says more of its direction than its line
// does.
constexpr double kOwnDirectionFrom_m = 1.0;
constexpr double kReach_m = 3;  // from a hidden part of a wall to a part that was seen
constexpr double kLeastCornerSine = 0.17;
// Skirting boards, frames and paintings are near the line, too: the fit begins where most of the
// surface is, and what is off by more than these has less and less weight (Geman and McClure).
constexpr double kScales_m[] = {0.02, 0.01, 0.005, 0.005, 0.005};
constexpr double kBin_m = 0.004;

struct Sample {
  double along_m = 0, off_m = 0, height_m = 0;  // off: from the line, towards the room
  const PlanFacet* facet = nullptr;
};

struct Straight {
  double along_m = 0, off_m = 0, slope = 0;  // through this place
  double at(double place_m) const { return off_m + slope * (place_m - along_m); }
};

// The distance from the line at which there is most surface.
double mode_m(const std::vector<Sample>& samples) {
  std::map<int, int> bins;
  for (const Sample& sample : samples) ++bins[static_cast<int>(std::floor(sample.off_m / kBin_m))];
  int best = 0, most = 0;
  for (const auto& [bin, unused] : bins) {
    int count = 0;
    for (int near = bin - 1; near <= bin + 1; ++near)
      if (const auto found = bins.find(near); found != bins.end()) count += found->second;
    if (count <= most) continue;
    most = count;
    best = bin;
  }
  return (best + 0.5) * kBin_m;
}

double weight_of(double off_m, double scale_m) {
  return std::pow(1 + std::pow(off_m / scale_m, 2), -2);
}

Straight refitted(const std::vector<Sample>& samples, const Straight& last, double scale_m,
                  bool turns) {
  double weights = 0;
  Straight found{0, 0, 0};
  for (const Sample& sample : samples) {
    const double weight = weight_of(sample.off_m - last.at(sample.along_m), scale_m);
    weights += weight;
    found.along_m += weight * sample.along_m;
    found.off_m += weight * sample.off_m;
  }
  found.along_m /= weights;
  found.off_m /= weights;
  if (!turns) return found;
  double square = 0, product = 0;
  for (const Sample& sample : samples) {
    const double weight = weight_of(sample.off_m - last.at(sample.along_m), scale_m);
    square += weight * std::pow(sample.along_m - found.along_m, 2);
    product += weight * (sample.along_m - found.along_m) * (sample.off_m - found.off_m);
  }
  if (square > 0) found.slope = product / square;
  return found;
}

struct WallLineFit {
  Straight straight;
  // Mean over all samples of the distance of those that do not lie on it: another surface may be
  // the wall, as beside a door frame.
  double other_m = 0;
};

// Keeps the samples that lie on it.
WallLineFit fitted(std::vector<Sample>& samples, bool turns) {
  WallLineFit fit{{0, mode_m(samples), 0}};
  for (const double scale_m : kScales_m)
    fit.straight = refitted(samples, fit.straight, scale_m, turns);
  const auto off_m = [&fit](const Sample& sample) {
    return std::abs(sample.off_m - fit.straight.at(sample.along_m));
  };
  const auto lies_on_it = [&off_m](const Sample& sample) {
    return off_m(sample) <= 2 * std::end(kScales_m)[-1];
  };
  for (const Sample& sample : samples)
    if (!lies_on_it(sample)) fit.other_m += off_m(sample) / static_cast<double>(samples.size());
  std::erase_if(samples, [&lies_on_it](const Sample& sample) { return !lies_on_it(sample); });
  return fit;
}

// Standard deviation of the wall at a place along it.
double sigma_m(const std::vector<Sample>& samples, const Straight& straight, double place_m) {
  std::map<std::pair<int, int>, std::pair<double, int>> cells;
  double square = 0;
  for (const Sample& sample : samples) {
    auto& [sum, count] =
        cells[{static_cast<int>(std::floor(sample.along_m / measure::kPlaneCell_m)),
               static_cast<int>(std::floor(sample.height_m / measure::kPlaneCell_m))}];
    sum += sample.off_m - straight.at(sample.along_m);
    ++count;
    square += std::pow(sample.along_m - straight.along_m, 2);
  }
  double squares = 0;
  for (const auto& [cell, mean] : cells) squares += std::pow(mean.first / mean.second, 2);
  const auto count = static_cast<double>(cells.size());
  const double spread_m =
      std::max(measure::kPlaneCell_m, std::sqrt(square / static_cast<double>(samples.size())));
  const measure::PlaneErrors errors =
      measure::plane_errors_of(std::sqrt(squares / count), count, spread_m);
  return std::hypot(errors.height_sigma_m, errors.slope_sigma * (place_m - straight.along_m));
}

std::vector<Sample> samples_of(const WallLine& line, std::span<const PlanFacet> facets,
                               double from_m, double to_m) {
  std::vector<Sample> samples;
  for (const PlanFacet& facet : facets) {
    if (!is_of_wall(line, facet) || facet.at_m.z() < kAboveFloor_m) continue;
    const double along_m = line.place_m(facet.at_m.head<2>());
    if (along_m >= from_m && along_m <= to_m)
      samples.push_back({along_m, line.distance_m(facet.at_m.head<2>()), facet.at_m.z(), &facet});
  }
  return samples;
}

measure::MeasuredPlace place_near(const std::vector<Sample>& samples, double along_m,
                                  const Eigen::Vector3d& normal, const PlanFrame& frame) {
  const auto nearest =
      std::min_element(samples.begin(), samples.end(), [&](const Sample& a, const Sample& b) {
        return std::abs(a.along_m - along_m) < std::abs(b.along_m - along_m);
      });
  measure::MeasuredPlace place;
  place.position_m = frame.to_world(nearest->facet->at_m);
  place.normal = frame.plan_from_world.transpose() * normal;
  place.submap = nearest->facet->submap;
  return place;
}

}  // namespace

FittedWall unseen_wall(const OutlineEdge& edge) {
  const Vector2d along = (edge.to_m - edge.from_m).normalized();
  FittedWall wall;
  wall.normal = {-along.y(), along.x()};
  wall.offset_m = wall.normal.dot(edge.from_m);
  return wall;
}

FittedWall fit_wall(const OutlineEdge& edge, const WallLine& line,
                    std::span<const PlanFacet> facets, const PlanFrame& frame) {
  if (!edge.faces_it) return unseen_wall(edge);
  const double from_m = line.place_m(edge.from_m), to_m = line.place_m(edge.to_m);
  const double margin_m = std::min(kFromCorner_m, 0.25 * (to_m - from_m));
  std::vector<Sample> samples = samples_of(line, facets, from_m + margin_m, to_m - margin_m);
  // Where furniture hides it, the wall is where the rest of it leads.
  if (samples.size() < kLeastFacets)
    samples = samples_of(line, facets, from_m - kReach_m, to_m + kReach_m);
  if (samples.size() < kLeastFacets) return unseen_wall(edge);
  const auto [first, last] =
      std::minmax_element(samples.begin(), samples.end(),
                          [](const Sample& a, const Sample& b) { return a.along_m < b.along_m; });
  const auto [straight, other_m] =
      fitted(samples, last->along_m - first->along_m >= kOwnDirectionFrom_m);
  if (samples.size() < kLeastFacets) return unseen_wall(edge);
  FittedWall wall;
  wall.normal = (line.normal - straight.slope * line.along()).normalized();
  const double middle_m = 0.5 * (from_m + to_m);
  wall.offset_m = wall.normal.dot(line.at(middle_m) + straight.at(middle_m) * line.normal);
  wall.place = place_near(samples, middle_m, {wall.normal.x(), wall.normal.y(), 0}, frame);
  wall.place->normal_sigma_m = std::hypot(sigma_m(samples, straight, middle_m), other_m);
  return wall;
}

Vector2d corner_of(const FittedWall& first, const FittedWall& second, const Vector2d& otherwise) {
  Eigen::Matrix2d normals;
  normals << first.normal.transpose(), second.normal.transpose();
  if (std::abs(normals.determinant()) < kLeastCornerSine) return otherwise;
  return normals.inverse() * Vector2d(first.offset_m, second.offset_m);
}

}  // namespace hermite::plan
