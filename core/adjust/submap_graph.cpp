#include "core/adjust/submap_graph.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "core/adjust/bundle_noise.h"

namespace hermite::adjust {

namespace {

constexpr double kMetresPerRadian = 0.5;

// Standard deviations: dense tracking from one submap to the next also drifts by half a per cent of
// the path; a loop is off by the difference of two views of one place with a Kinect's noise
// (tests/accuracy/LAB.md).
constexpr double kGrowth = 0.005;
constexpr double kLoop_m = 0.003, kLoop_rad = 0.002;

// Several times the drift of good tracking, plus the error of any single view.
constexpr double kDriftFloor_m = 0.1, kDriftGrowth = 0.03;
constexpr double kDriftFloor_rad = 0.05, kDriftGrowth_rad_per_m = 0.02;

}  // namespace

double length_of(const Rigid3& a_from_b) {
  return a_from_b.translation.norm() + kMetresPerRadian * angle_rad(a_from_b.rotation);
}

bool is_within(const Rigid3& a_from_b, double distance_m, double turn_rad) {
  return a_from_b.translation.norm() < distance_m && angle_rad(a_from_b.rotation) < turn_rad;
}

std::uint32_t add_submap(SubmapGraph& graph, std::uint32_t component) {
  const auto submap = static_cast<std::uint32_t>(graph.component.size());
  graph.component.push_back(component);
  graph.parent.push_back(submap);
  return submap;
}

void link_tracked(SubmapGraph& graph, std::uint32_t from, std::uint32_t to,
                  const Rigid3& from_from_to) {
  for (const SubmapLink& link : graph.links)
    if (!link.is_loop && std::minmax(link.from, link.to) == std::minmax(from, to)) return;
  graph.links.push_back({from, to, from_from_to, length_of(from_from_to), false});
}

std::vector<double> distances_m(const SubmapGraph& graph, std::uint32_t from) {
  std::vector<std::vector<std::pair<std::uint32_t, double>>> neighbours(graph.component.size());
  for (const SubmapLink& link : graph.links) {
    neighbours[link.from].emplace_back(link.to, link.length_m);
    neighbours[link.to].emplace_back(link.from, link.length_m);
  }
  std::vector<double> distance_m(neighbours.size(), std::numeric_limits<double>::infinity());
  using Reached = std::pair<double, std::uint32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
  distance_m[from] = 0;
  next.emplace(0.0, from);
  while (!next.empty()) {
    const auto [reached_m, submap] = next.top();
    next.pop();
    if (reached_m > distance_m[submap]) continue;
    for (const auto& [neighbour, length_m] : neighbours[submap]) {
      if (reached_m + length_m >= distance_m[neighbour]) continue;
      distance_m[neighbour] = reached_m + length_m;
      next.emplace(distance_m[neighbour], neighbour);
    }
  }
  return distance_m;
}

Matrix6d information_of(const SubmapLink& link) {
  const double sigma_m =
      link.is_loop ? kLoop_m : kTracked_m + kGrowth * link.from_from_to.translation.norm();
  const double sigma_rad =
      link.is_loop ? kLoop_rad : kTracked_rad + kGrowth * angle_rad(link.from_from_to.rotation);
  Vector6d precision;
  precision.head<3>().setConstant(1 / (sigma_m * sigma_m));
  precision.tail<3>().setConstant(1 / (sigma_rad * sigma_rad));
  return precision.asDiagonal();
}

bool is_possible_drift(const Rigid3& drift, double path_m) {
  return drift.translation.norm() <= kDriftFloor_m + kDriftGrowth * path_m &&
         angle_rad(drift.rotation) <= kDriftFloor_rad + kDriftGrowth_rad_per_m * path_m;
}

}  // namespace hermite::adjust
