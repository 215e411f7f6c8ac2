#include "core/plan/plan_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/base/printf_text.h"

namespace hermite::plan {

namespace {

using Eigen::Vector3d;

constexpr double kRightAngle_rad = std::numbers::pi / 2;
constexpr int kHeadingBins = 90;  // of one degree: directions of walls repeat after a right angle
constexpr double kOfHeading_rad = 5 * std::numbers::pi / 180;
constexpr double kLeastFloor_m2 = 0.5, kLeastWall_m2 = 0.5, kLeastCeiling_m2 = 1;
constexpr double kLeastCeilingHeight_m = 1.8;  // the underside of a table or shelf is lower
// A floor may be smaller than the tables above it, of which more is seen, but not by more than
// this.
constexpr double kLeastOfLargestLevel = 0.2;
// This share of the upright surface is below the top, which single outliers must not define.
constexpr double kTopShare = 0.98;
constexpr double kMostWidth_m = 200;
constexpr double kFacet_m2 = kFacet_m * kFacet_m;

bool is_usable(const output::CloudPoint& point) {
  return point.position_m.allFinite() && point.normal.squaredNorm() > 0.5f;
}

Eigen::Matrix3d rotation_to(const Vector3d& up) {
  const Vector3d x = up.unitOrthogonal();
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), up.cross(x).transpose(), up.transpose();
  return rotation;
}

// Returns the direction that most upright surfaces are parallel or perpendicular to, in [0, 90)
// degrees.
double heading_rad(const output::Cloud& cloud, const Eigen::Matrix3d& rotation) {
  std::vector<double> angles_rad;
  std::vector<int> bins(kHeadingBins);
  for (const output::CloudPoint& point : cloud) {
    if (!is_usable(point)) continue;
    const Vector3d normal = rotation * point.normal.cast<double>();
    if (std::abs(normal.z()) > kUpright) continue;
    const double angle =
        std::fmod(std::atan2(normal.y(), normal.x()) + 2 * std::numbers::pi, kRightAngle_rad);
    angles_rad.push_back(angle);
    ++bins[static_cast<std::size_t>(angle / kRightAngle_rad * kHeadingBins) % kHeadingBins];
  }
  const auto around = [&](int bin) {
    int sum = 0;
    for (int off = -2; off <= 2; ++off)
      sum += bins[static_cast<std::size_t>((bin + off + kHeadingBins) % kHeadingBins)];
    return sum;
  };
  int best = 0;
  for (int bin = 1; bin < kHeadingBins; ++bin)
    if (around(bin) > around(best)) best = bin;
  const double peak_rad = (best + 0.5) / kHeadingBins * kRightAngle_rad;
  double sum_rad = 0;
  int count = 0;
  for (const double angle : angles_rad) {
    const double off_rad = std::remainder(angle - peak_rad, kRightAngle_rad);
    if (std::abs(off_rad) > kOfHeading_rad) continue;
    sum_rad += off_rad;
    ++count;
  }
  return count > 0 ? peak_rad + sum_rad / count : peak_rad;
}

Eigen::Matrix3d turned(const Eigen::Matrix3d& rotation, double angle_rad) {
  Eigen::Matrix3d turn;
  turn << std::cos(angle_rad), std::sin(angle_rad), 0, -std::sin(angle_rad), std::cos(angle_rad), 0,
      0, 0, 1;
  return turn * rotation;
}

// Which of the six directions of the axes a normal is nearest to.
std::uint64_t side_of(const Vector3d& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint64_t>(2 * axis + (normal[axis] < 0 ? 1 : 0));
}

struct FacetSum {
  Vector3d at_m = Vector3d::Zero(), normal = Vector3d::Zero();
  double weight = 0;
  std::uint32_t submap = 0;
};

std::vector<PlanFacet> facets_of(const output::Cloud& cloud, const PlanFrame& frame) {
  constexpr std::uint64_t kAxisBits = 20;
  constexpr double kAxisMiddle = 1 << (kAxisBits - 1);
  std::unordered_map<std::uint64_t, FacetSum> sums;
  for (const output::CloudPoint& point : cloud) {
    if (!is_usable(point)) continue;
    const Vector3d at_m = frame.to_plan(point.position_m.cast<double>()),
                   normal = frame.plan_from_world * point.normal.cast<double>();
    std::uint64_t key = side_of(normal);
    for (int axis = 0; axis < 3; ++axis)
      key = key << kAxisBits | static_cast<std::uint64_t>(at_m[axis] / kFacet_m + kAxisMiddle);
    FacetSum& sum = sums[key];
    const double weight = std::sqrt(std::max(1e-3, double{point.confidence}));
    sum.at_m += weight * at_m;
    sum.normal += weight * normal;
    sum.weight += weight;
    sum.submap = point.submap;
  }
  std::vector<std::pair<std::uint64_t, const FacetSum*>> ordered;
  for (const auto& [key, sum] : sums) ordered.emplace_back(key, &sum);
  std::sort(ordered.begin(), ordered.end());
  std::vector<PlanFacet> facets;
  for (const auto& [key, sum] : ordered)
    facets.push_back({sum->at_m / sum->weight, sum->normal.normalized(), sum->submap});
  return facets;
}

struct Level {
  double height_m = 0, area_m2 = 0;
};

// Returns the levels of the surfaces that face up (`sign` 1) or down (-1), from low to high.
std::vector<Level> levels_of(const std::vector<PlanFacet>& facets, double sign) {
  std::map<int, std::pair<int, double>> bins;  // number of facets and the sum of their heights
  for (const PlanFacet& facet : facets) {
    if (sign * facet.normal.z() < kLevelCosine) continue;
    auto& [count, sum_m] = bins[static_cast<int>(std::floor(facet.at_m.z() / kFacet_m))];
    ++count;
    sum_m += facet.at_m.z();
  }
  const auto count_in = [&](int bin) { return bins.contains(bin) ? bins.at(bin).first : 0; };
  std::vector<Level> levels;
  for (const auto& [bin, content] : bins) {
    if (content.first < count_in(bin - 1) || content.first <= count_in(bin + 1)) continue;
    int count = 0;
    double sum_m = 0;
    for (int near = bin - 1; near <= bin + 1; ++near)
      if (bins.contains(near)) {
        count += bins.at(near).first;
        sum_m += bins.at(near).second;
      }
    levels.push_back({sum_m / count, count * kFacet_m2});
  }
  return levels;
}

std::optional<Level> floor_of(const std::vector<Level>& levels) {
  double largest_m2 = 0;
  for (const Level& level : levels) largest_m2 = std::max(largest_m2, level.area_m2);
  for (const Level& level : levels)
    if (level.area_m2 >= std::max(kLeastFloor_m2, kLeastOfLargestLevel * largest_m2)) return level;
  return std::nullopt;
}

std::optional<Level> ceiling_of(const std::vector<Level>& levels, double floor_m) {
  std::optional<Level> best;
  for (const Level& level : levels)
    if (level.height_m > floor_m + kLeastCeilingHeight_m && level.area_m2 >= kLeastCeiling_m2 &&
        (!best || level.area_m2 > best->area_m2))
      best = level;
  return best;
}

}  // namespace

Result<PlanSurface> plan_surface_of(const output::Cloud& cloud, const Vector3d& up) {
  Vector3d low_m = Vector3d::Constant(std::numeric_limits<double>::infinity()), high_m = -low_m;
  for (const output::CloudPoint& point : cloud) {
    if (!is_usable(point)) continue;
    low_m = low_m.cwiseMin(point.position_m.cast<double>());
    high_m = high_m.cwiseMax(point.position_m.cast<double>());
  }
  if ((high_m - low_m).maxCoeff() > kMostWidth_m)
    return Error{ErrorCode::kTooLarge,
                 printf_text("the scan is %.0f m wide; a floor plan is made of at most %.0f m",
                             (high_m - low_m).maxCoeff(), kMostWidth_m)};
  PlanSurface surface;
  PlanFrame& frame = surface.frame;
  frame.origin_m =
      low_m.allFinite() ? Vector3d(0.5 * (low_m + high_m)) : Vector3d(Vector3d::Zero());
  frame.plan_from_world = rotation_to(up);
  frame.plan_from_world = turned(frame.plan_from_world, heading_rad(cloud, frame.plan_from_world));
  surface.facets = facets_of(cloud, frame);
  const std::optional<Level> floor = floor_of(levels_of(surface.facets, 1));
  if (!floor)
    return Error{ErrorCode::kInvalidArgument,
                 "the scan shows no floor: there is no level surface of 0.5 m² that faces up"};
  frame.origin_m += floor->height_m * up;
  std::vector<double> heights_m;
  for (PlanFacet& facet : surface.facets) {
    facet.at_m.z() -= floor->height_m;
    if (std::abs(facet.normal.z()) < kUpright) heights_m.push_back(facet.at_m.z());
  }
  if (static_cast<double>(heights_m.size()) * kFacet_m2 < kLeastWall_m2)
    return Error{ErrorCode::kInvalidArgument,
                 "the scan shows no walls: less than 0.5 m² of its surface is upright"};
  const auto ceiling = ceiling_of(levels_of(surface.facets, -1), 0);
  frame.has_ceiling = ceiling.has_value();
  const auto top = heights_m.begin() + static_cast<std::ptrdiff_t>(
                                           kTopShare * static_cast<double>(heights_m.size() - 1));
  std::nth_element(heights_m.begin(), top, heights_m.end());
  frame.top_m = ceiling ? ceiling->height_m : *top;
  return surface;
}

}  // namespace hermite::plan
