#include "core/measure/surface_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/math/principal_axes.h"

namespace hermite::measure {

namespace {

using Eigen::Vector3d;

// Within 3 cm there are about 30 surfels of a room that was seen from 2.7 m; if there are fewer
// than these, the reach is doubled.
constexpr double kNearReach_m = 0.03;
constexpr std::size_t kEnough = 16, kLeast = 6;
// The nearest surfels determine which side of an object is meant.
constexpr std::size_t kDirectionOf = 5;
// Surfels have weight if their normals are within 37 degrees of the plane's, and full weight if
// they agree.
constexpr double kLeastCosine = 0.8;
// Tukey's weight, zero beyond this many standard deviations; the deviation is at least the rounding
// of depth from a still camera.
constexpr double kOutlierDeviations = 3, kLeastDeviation_m = 0.0005;
constexpr int kRounds = 5;

// Factors of the spread and of the bend for a point's standard deviation, and what remains if both
// are zero. Measured.
constexpr double kOfNoise = 7.6, kOfBend = 4.2, kLeastSigma_m = 0.0004;

struct Neighbour {
  Vector3d position_m, normal;
  double weight = 0;  // from its distance and confidence
  double distance_m = 0;
  std::uint32_t submap = 0;
};

struct Plane {
  Vector3d centre_m, normal;
  double deviation_m = 0;      // of the surfels from the plane
  double effective_count = 0;  // of surfels
  double disagreement = 0;     // mean of 1 - cosine between their normals and the plane's
};

std::vector<Neighbour> neighbours_of(std::span<const output::CloudPoint> points,
                                     const Vector3d& pick) {
  std::vector<Neighbour> found;
  for (const output::CloudPoint& point : points) {
    const Vector3d position_m = point.position_m.cast<double>(),
                   normal = point.normal.cast<double>();
    const double distance_m = (position_m - pick).norm();
    if (!(distance_m <= kFitReach_m) || !(std::abs(normal.norm() - 1) < 0.1) ||
        !(point.confidence >= 0))
      continue;
    found.push_back(
        {position_m, normal, std::sqrt(double{point.confidence}), distance_m, point.submap});
  }
  std::stable_sort(found.begin(), found.end(), [](const Neighbour& a, const Neighbour& b) {
    return a.distance_m < b.distance_m;
  });
  const auto near = std::partition_point(
      found.begin(), found.end(), [](const Neighbour& n) { return n.distance_m <= kNearReach_m; });
  double reach_m = kFitReach_m;
  if (near - found.begin() >= static_cast<std::ptrdiff_t>(kEnough)) {
    found.erase(near, found.end());
    reach_m = kNearReach_m;
  }
  for (Neighbour& neighbour : found)
    neighbour.weight *= std::exp(-2 * std::pow(neighbour.distance_m / reach_m, 2));
  return found;
}

Vector3d direction_of(const std::vector<Neighbour>& neighbours) {
  Vector3d direction = Vector3d::Zero();
  for (std::size_t i = 0; i < std::min(kDirectionOf, neighbours.size()); ++i)
    direction += neighbours[i].normal *
                 std::pow(std::max(0.0, neighbours[i].normal.dot(neighbours[0].normal)), 2);
  return direction.normalized();
}

double weight_in(const Plane& plane, const Neighbour& neighbour, bool is_first) {
  const double agreement = std::clamp(
      (neighbour.normal.dot(plane.normal) - kLeastCosine) / (1 - kLeastCosine), 0.0, 1.0);
  if (is_first) return neighbour.weight * agreement;
  const double off = plane.normal.dot(neighbour.position_m - plane.centre_m) /
                     (kOutlierDeviations * std::max(plane.deviation_m, kLeastDeviation_m));
  return neighbour.weight * agreement * std::pow(std::max(0.0, 1 - off * off), 2);
}

// Returns std::nullopt if too few surfels agree.
std::optional<Plane> refitted(const Plane& plane, const std::vector<Neighbour>& neighbours,
                              bool is_first) {
  std::vector<Vector3d> positions_m;
  std::vector<double> weights;
  double sum = 0, squares = 0;
  for (const Neighbour& neighbour : neighbours) {
    positions_m.push_back(neighbour.position_m);
    weights.push_back(weight_in(plane, neighbour, is_first));
    sum += weights.back();
    squares += weights.back() * weights.back();
  }
  if (static_cast<std::size_t>(
          std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0; })) < kLeast)
    return std::nullopt;
  const PrincipalAxes axes = principal_axes(positions_m, weights);
  Plane fitted{axes.centre, facing(axes.direction[2], plane.normal), axes.deviation[2],
               sum * sum / squares, 0};
  for (std::size_t i = 0; i < weights.size(); ++i)
    fitted.disagreement += weights[i] / sum * (1 - neighbours[i].normal.dot(fitted.normal));
  return fitted;
}

}  // namespace

Result<MeasuredPlace> fit_surface_point(std::span<const output::CloudPoint> points,
                                        const Vector3d& pick) {
  if (!pick.allFinite()) return Error{ErrorCode::kInvalidArgument, "the point is not finite"};
  const Error nothing{ErrorCode::kNotFound, "no surface was seen within 6 cm of the point"};
  const std::vector<Neighbour> neighbours = neighbours_of(points, pick);
  if (neighbours.size() < kLeast) return nothing;
  const double reach_m =
      neighbours.size() >= kEnough && neighbours.back().distance_m <= kNearReach_m ? kNearReach_m
                                                                                   : kFitReach_m;
  Plane plane{pick, direction_of(neighbours), 0, 0, 0};
  for (int round = 0; round < kRounds; ++round) {
    const std::optional<Plane> fitted = refitted(plane, neighbours, round == 0);
    if (!fitted)
      return Error{ErrorCode::kNotFound,
                   "the surface is too broken around the point to be measured"};
    plane = *fitted;
  }
  MeasuredPlace found;
  found.position_m = pick - plane.normal * plane.normal.dot(pick - plane.centre_m);
  found.normal = plane.normal;
  found.noise_m = plane.deviation_m / std::sqrt(plane.effective_count);
  found.bend_m = reach_m * std::max(0.0, plane.disagreement);
  found.normal_sigma_m =
      std::hypot(kOfNoise * found.noise_m, kOfBend * found.bend_m, kLeastSigma_m);
  found.submap = neighbours.front().submap;
  return found;
}

}  // namespace hermite::measure
