// The cells into which the lines of all walls cut the ground of a scan, and which of them are
// inside of rooms. Pure functions. Any thread.
//
// Lines go on beyond their walls, so a room consists of many cells. Inside is what minimizes the
// sum of: the ground inside over which nothing was seen, the seen ground outside, and the length of
// the boundary between inside and outside on which no wall was seen (minimum_cut.h).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/plan/wall_lines.h"

namespace hermite::plan {

// Of the edges on the border of the whole ground.
inline constexpr int kNoLine = -1;

// A convex polygon, counter-clockwise. Edge i leads from corner i to the next one.
struct PlanCell {
  std::uint64_t key = 0;  // bit k: it is on the room's side of line k
  std::vector<Eigen::Vector2d> corners;
  std::vector<int> lines;  // of each edge
  double area_m2 = 0;
  // Part of it that was looked through, or over which a horizontal surface was seen.
  double seen_m2 = 0;
  bool is_inside = false;
  int room = -1;  // of those inside, from 0
};

struct PlanCells {
  std::vector<PlanCell> cells;
  std::unordered_map<std::uint64_t, std::size_t> index_of;  // by key
  int room_count = 0;

  // Returns the index of the cell on the other side of an edge; SIZE_MAX: there is none.
  std::size_t across(const PlanCell& cell, int line) const;
};

// kTooLarge: too many cells. Rooms are cells inside that no wall separates.
// Without lines of sight, horizontal surfaces alone show what is inside.
Result<PlanCells> plan_cells_of(const PlanSurface& surface, const std::vector<WallLine>& lines,
                                const std::vector<SightLine>& sight_lines);

// Returns how much of the wall along an edge was seen from the side of its cell.
double edge_support(const PlanCell& cell, std::size_t edge, const std::vector<WallLine>& lines);

}  // namespace hermite::plan
