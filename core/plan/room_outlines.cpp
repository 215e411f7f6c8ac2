#include "core/plan/room_outlines.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace hermite::plan {

namespace {

using Eigen::Vector2d;

constexpr double kSamePlace_m = 1e-4;
constexpr double kLeastEdge_m = 1e-5;

std::vector<OutlineEdge> edges_of(const PlanCells& plan, int room) {
  std::vector<OutlineEdge> edges;
  for (const PlanCell& cell : plan.cells) {
    if (cell.room != room) continue;
    for (std::size_t i = 0; i < cell.lines.size(); ++i) {
      const int line = cell.lines[i];
      const std::size_t other = line == kNoLine ? plan.cells.size() : plan.across(cell, line);
      if (other < plan.cells.size() && plan.cells[other].room == room) continue;
      const Vector2d &from = cell.corners[i], &to = cell.corners[(i + 1) % cell.corners.size()];
      if ((to - from).norm() < kLeastEdge_m) continue;
      edges.push_back({from, to, line, line != kNoLine && (cell.key >> line & 1) != 0});
    }
  }
  return edges;
}

// Takes the edge that goes on from the end of `last`; where several do, the one that turns most to
// the left, which keeps two loops that touch in a corner apart.
std::size_t next_of(const OutlineEdge& last, const std::vector<OutlineEdge>& edges,
                    const std::vector<bool>& taken) {
  std::size_t best = edges.size();
  double best_turn_rad = -std::numeric_limits<double>::infinity();
  const Vector2d direction = last.to_m - last.from_m;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (taken[i] || (edges[i].from_m - last.to_m).norm() > kSamePlace_m) continue;
    const Vector2d then = edges[i].to_m - edges[i].from_m;
    const double turn_rad =
        std::atan2(direction.x() * then.y() - direction.y() * then.x(), direction.dot(then));
    if (turn_rad <= best_turn_rad) continue;
    best = i;
    best_turn_rad = turn_rad;
  }
  return best;
}

// Joins neighbours on the same line.
OutlineLoop joined(const OutlineLoop& loop) {
  OutlineLoop result;
  const auto is_same = [](const OutlineEdge& a, const OutlineEdge& b) {
    const Vector2d first = a.to_m - a.from_m, second = b.to_m - b.from_m;
    const bool is_straight = std::abs(first.x() * second.y() - first.y() * second.x()) <
                             1e-6 * first.norm() * second.norm();
    return a.line == b.line && a.faces_it == b.faces_it && is_straight && first.dot(second) > 0;
  };
  for (const OutlineEdge& edge : loop) {
    if (!result.empty() && is_same(result.back(), edge))
      result.back().to_m = edge.to_m;
    else
      result.push_back(edge);
  }
  if (result.size() > 1 && is_same(result.back(), result.front())) {
    result.front().from_m = result.back().from_m;
    result.pop_back();
  }
  return result;
}

}  // namespace

std::vector<OutlineLoop> outlines_of(const PlanCells& plan, int room) {
  const std::vector<OutlineEdge> edges = edges_of(plan, room);
  std::vector<bool> taken(edges.size());
  std::vector<OutlineLoop> loops;
  for (std::size_t first = 0; first < edges.size(); ++first) {
    if (taken[first]) continue;
    OutlineLoop loop;
    for (std::size_t at = first; at < edges.size(); at = next_of(loop.back(), edges, taken)) {
      taken[at] = true;
      loop.push_back(edges[at]);
    }
    if (OutlineLoop whole = joined(loop); whole.size() >= 3) loops.push_back(std::move(whole));
  }
  std::stable_sort(loops.begin(), loops.end(), [](const OutlineLoop& a, const OutlineLoop& b) {
    return area_m2_of(a) > area_m2_of(b);
  });
  return loops;
}

}  // namespace hermite::plan
