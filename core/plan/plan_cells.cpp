#include "core/plan/plan_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>
#include <utility>

#include "core/plan/minimum_cut.h"

namespace hermite::plan {

namespace {

using Eigen::Vector2d;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr double kMargin_m = 0.3;    // of the ground around the scan
constexpr double kSquare_m = 0.025;  // in which the ground is looked at
constexpr double kHair_m = 1e-6;     // corners this close to a line are on it
constexpr std::size_t kMostCells = 1 << 14;
// What is not seen may be hidden by furniture: it speaks less for outside than surface speaks for
// inside.
constexpr double kUnseenWorth = 0.25;
// A metre of boundary without a wall is as bad as a third of a square metre on the wrong side.
constexpr double kOpenBoundary_m = 0.35;
// A boundary costs a little where there is a wall, too, or the cells in noise would be cut out one
// by one.
constexpr double kLeastBoundary = 0.05;
constexpr double kSeparates = 0.5;    // least support of a wall between two rooms
constexpr double kFurniture_m = 0.7;  // depth of what stands at a wall
constexpr double kThickestWall_m = 0.45, kParallel = 0.98;
constexpr double kNever = 1e9;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double area_of(const std::vector<Vector2d>& corners) {
  double twice = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    twice += cross(corners[i], corners[(i + 1) % corners.size()]);
  return twice / 2;
}

// Returns the part of the cell on one side of a line; without corners if there is none.
PlanCell part_of(const PlanCell& cell, const WallLine& line, int index, double side) {
  PlanCell part;
  part.key = cell.key;
  const std::size_t count = cell.corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d &from = cell.corners[i], &to = cell.corners[(i + 1) % count];
    const double from_m = side * line.distance_m(from), to_m = side * line.distance_m(to);
    if (from_m >= 0) {
      part.corners.push_back(from);
      part.lines.push_back(to_m < 0 && from_m == 0 ? index : cell.lines[i]);
    }
    if ((from_m > 0 && to_m < 0) || (from_m < 0 && to_m > 0)) {
      part.corners.push_back(from + (to - from) * (from_m / (from_m - to_m)));
      part.lines.push_back(from_m > 0 ? index : cell.lines[i]);
    }
  }
  return part;
}

void cut(std::vector<PlanCell>& cells, const WallLine& line, int index) {
  const std::uint64_t bit = std::uint64_t{1} << index;
  std::vector<PlanCell> parts;
  for (PlanCell& cell : cells) {
    double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
    for (const Vector2d& corner : cell.corners) {
      low_m = std::min(low_m, line.distance_m(corner));
      high_m = std::max(high_m, line.distance_m(corner));
    }
    if (low_m < -kHair_m && high_m > kHair_m) {
      PlanCell behind = part_of(cell, line, index, -1);
      if (behind.corners.size() >= 3) parts.push_back(std::move(behind));
      cell = part_of(cell, line, index, 1);
      cell.key |= bit;
    } else if (high_m > kHair_m) {
      cell.key |= bit;
    }
  }
  std::erase_if(cells, [](const PlanCell& cell) { return cell.corners.size() < 3; });
  std::move(parts.begin(), parts.end(), std::back_inserter(cells));
}

PlanCell ground_of(const PlanSurface& surface) {
  Vector2d low_m = surface.facets.front().at_m.head<2>(), high_m = low_m;
  for (const PlanFacet& facet : surface.facets) {
    low_m = low_m.cwiseMin(facet.at_m.head<2>());
    high_m = high_m.cwiseMax(facet.at_m.head<2>());
  }
  low_m.array() -= kMargin_m;
  high_m.array() += kMargin_m;
  PlanCell ground;
  ground.corners = {low_m, {high_m.x(), low_m.y()}, high_m, {low_m.x(), high_m.y()}};
  ground.lines.assign(4, kNoLine);
  return ground;
}

// The squares of the ground above which the camera looked through, or with a horizontal surface:
// walls have two sides, and what is above a floor has not.
class SeenGround {
 public:
  SeenGround(PlanCells& plan, const std::vector<WallLine>& lines) : plan_(plan), lines_(lines) {}

  void see(const Vector2d& at_m) {
    const auto number = [](double place_m) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(place_m / kSquare_m)));
    };
    const std::uint64_t square = number(at_m.x()) << 32 | (number(at_m.y()) & 0xffffffff);
    std::uint64_t key = 0;
    for (std::size_t k = 0; k < lines_.size(); ++k)
      if (lines_[k].distance_m(at_m) > 0) key |= std::uint64_t{1} << k;
    if (!known_.insert(square ^ key * 0x9e3779b97f4a7c15u).second) return;
    if (const auto found = plan_.index_of.find(key); found != plan_.index_of.end())
      plan_.cells[found->second].seen_m2 += kSquare_m * kSquare_m;
  }

 private:
  PlanCells& plan_;
  const std::vector<WallLine>& lines_;
  std::unordered_set<std::uint64_t> known_;  // squares in a cell, mixed
};

void see_ground(PlanCells& plan, const PlanSurface& surface, const std::vector<WallLine>& lines,
                const std::vector<SightLine>& sight_lines) {
  SeenGround ground(plan, lines);
  for (const PlanFacet& facet : surface.facets)
    if (std::abs(facet.normal.z()) >= kLevelCosine) ground.see(facet.at_m.head<2>());
  for (const SightLine& sight : sight_lines) {
    const Vector2d from_m = sight.from_m.head<2>(), way_m = sight.to_m.head<2>() - from_m;
    const int steps = static_cast<int>(way_m.norm() / kSquare_m);
    for (int i = 0; i <= steps; ++i)
      ground.see(from_m + way_m * (static_cast<double>(i) / std::max(1, steps)));
  }
  for (PlanCell& cell : plan.cells) cell.seen_m2 = std::min(cell.seen_m2, cell.area_m2);
}

double edge_length_m(const PlanCell& cell, std::size_t edge) {
  return (cell.corners[(edge + 1) % cell.corners.size()] - cell.corners[edge]).norm();
}

double support_along(const WallLine& line, const PlanCell& cell, std::size_t edge) {
  const double from_m = line.place_m(cell.corners[edge]),
               to_m = line.place_m(cell.corners[(edge + 1) % cell.corners.size()]);
  return wall_support(line, std::min(from_m, to_m), std::max(from_m, to_m));
}

// What it costs that the cell is inside and the one across the edge is not.
double boundary_cost(const PlanCell& cell, std::size_t edge, const std::vector<WallLine>& lines) {
  const double support = edge_support(cell, edge, lines);
  return kOpenBoundary_m * edge_length_m(cell, edge) * std::max(kLeastBoundary, 1 - support);
}

// Whether a cell is the inside of a wall or a cupboard: behind two lines that face away from each
// other, one of which was seen along it.
bool is_within_wall(const PlanCell& cell, const std::vector<WallLine>& lines) {
  const auto is_behind = [&](int line) { return line != kNoLine && (cell.key >> line & 1) == 0; };
  for (std::size_t edge = 0; edge < cell.lines.size(); ++edge) {
    if (!is_behind(cell.lines[edge])) continue;
    const WallLine& line = lines[static_cast<std::size_t>(cell.lines[edge])];
    if (support_along(line, cell, edge) < kSeparates) continue;
    for (const int opposite : cell.lines) {
      if (!is_behind(opposite) ||
          lines[static_cast<std::size_t>(opposite)].normal.dot(line.normal) > -kParallel)
        continue;
      const Vector2d middle =
          0.5 * (cell.corners[edge] + cell.corners[(edge + 1) % cell.corners.size()]);
      if (-lines[static_cast<std::size_t>(opposite)].distance_m(middle) <= kThickestWall_m)
        return true;
    }
  }
  return false;
}

void find_inside(PlanCells& plan, const std::vector<WallLine>& lines) {
  std::vector<SideCost> sides;
  std::vector<BoundaryCost> boundaries;
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    const PlanCell& cell = plan.cells[i];
    const bool is_wall = is_within_wall(cell, lines);
    sides.push_back({is_wall ? kNever : kUnseenWorth * (cell.area_m2 - cell.seen_m2),
                     is_wall ? 0 : cell.seen_m2});
    for (std::size_t edge = 0; edge < cell.lines.size(); ++edge) {
      const std::size_t other =
          cell.lines[edge] == kNoLine ? kNone : plan.across(cell, cell.lines[edge]);
      const double cost = boundary_cost(cell, edge, lines);
      if (other == kNone)
        sides.back().inside += cost;  // what is beyond the border is outside
      else
        boundaries.push_back({i, other, cost});
    }
  }
  const std::vector<bool> inside = minimum_cut(sides, boundaries);
  for (std::size_t i = 0; i < plan.cells.size(); ++i) plan.cells[i].is_inside = inside[i];
}

// Whether a cell behind this line is the space beside furniture that stands at a wall: the wall is
// close behind, and faces the same way.
bool is_before_wall(const PlanCell& cell, int line, const std::vector<WallLine>& lines) {
  if ((cell.key >> line & 1) != 0) return false;
  const WallLine& front = lines[static_cast<std::size_t>(line)];
  for (std::size_t edge = 0; edge < cell.lines.size(); ++edge) {
    const int behind = cell.lines[edge];
    if (behind == kNoLine || behind == line || (cell.key >> behind & 1) == 0) continue;
    const Vector2d middle =
        0.5 * (cell.corners[edge] + cell.corners[(edge + 1) % cell.corners.size()]);
    if (lines[static_cast<std::size_t>(behind)].normal.dot(front.normal) > kParallel &&
        -front.distance_m(middle) <= kFurniture_m)
      return true;
  }
  return false;
}

void find_rooms(PlanCells& plan, const std::vector<WallLine>& lines) {
  for (std::size_t first = 0; first < plan.cells.size(); ++first) {
    if (!plan.cells[first].is_inside || plan.cells[first].room >= 0) continue;
    plan.cells[first].room = plan.room_count;
    std::vector<std::size_t> next{first};
    while (!next.empty()) {
      const std::size_t at = next.back();
      next.pop_back();
      for (std::size_t edge = 0; edge < plan.cells[at].lines.size(); ++edge) {
        const int line = plan.cells[at].lines[edge];
        const std::size_t other = line == kNoLine ? kNone : plan.across(plan.cells[at], line);
        if (other == kNone || !plan.cells[other].is_inside || plan.cells[other].room >= 0) continue;
        const PlanCell& beside = plan.cells[other];
        const auto back = static_cast<std::size_t>(
            std::find(beside.lines.begin(), beside.lines.end(), line) - beside.lines.begin());
        const double seen =
            std::max(edge_support(plan.cells[at], edge, lines),
                     back < beside.lines.size() ? edge_support(beside, back, lines) : 0);
        const bool is_furniture =
            is_before_wall(plan.cells[at], line, lines) || is_before_wall(beside, line, lines);
        if (seen >= kSeparates && !is_furniture) continue;
        plan.cells[other].room = plan.room_count;
        next.push_back(other);
      }
    }
    ++plan.room_count;
  }
}

}  // namespace

std::size_t PlanCells::across(const PlanCell& cell, int line) const {
  const auto found = index_of.find(cell.key ^ (std::uint64_t{1} << line));
  return found == index_of.end() ? kNone : found->second;
}

double edge_support(const PlanCell& cell, std::size_t edge, const std::vector<WallLine>& lines) {
  if (cell.lines[edge] == kNoLine) return 0;
  const WallLine& line = lines[static_cast<std::size_t>(cell.lines[edge])];
  const bool faces_it = (cell.key >> cell.lines[edge] & 1) != 0;
  if (!faces_it) return 0;
  return support_along(line, cell, edge);
}

Result<PlanCells> plan_cells_of(const PlanSurface& surface, const std::vector<WallLine>& lines,
                                const std::vector<SightLine>& sight_lines) {
  PlanCells plan;
  plan.cells = {ground_of(surface)};
  for (std::size_t k = 0; k < lines.size(); ++k) {
    cut(plan.cells, lines[k], static_cast<int>(k));
    if (plan.cells.size() > kMostCells)
      return Error{ErrorCode::kTooLarge,
                   "the walls of the scan have too many directions for a floor plan"};
  }
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    plan.cells[i].area_m2 = area_of(plan.cells[i].corners);
    plan.index_of[plan.cells[i].key] = i;
  }
  see_ground(plan, surface, lines, sight_lines);
  find_inside(plan, lines);
  find_rooms(plan, lines);
  return plan;
}

}  // namespace hermite::plan
