// The walls of a floor plan as straight lines: upright planes that reach high enough. Pure
// functions. Any thread.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/plan/plan_frame.h"
#include "core/plan/sight_lines.h"

namespace hermite::plan {

// As many as a cell's key has bits (plan_cells.h).
inline constexpr std::size_t kMostWallLines = 64;

// Surface farther than this from a line, or turned by more than the cosine, is not of its wall.
inline constexpr double kWallBand_m = 0.04, kWallCosine = 0.9;

// What is seen of the wall along its line: columns from left to right seen from the room, and in
// each of them one bit for each row, the lowest first. Higher rows than 64 are left out.
inline constexpr double kColumn_m = 0.05, kRow_m = 0.1;

struct WallLine {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // unit, towards the room
  double offset_m = 0;                                // normal.dot(point) of its points
  double first_m = 0;                                 // place along the line of the first column
  std::vector<std::uint64_t> columns;
  std::vector<double> support;  // of each column, with doorways closed
  // By column: there is floor just behind the line, as in a doorway.
  std::vector<bool> floor_behind;
  std::vector<std::uint64_t> passed;  // as columns: where a line of sight went through

  // The room is on the left of one who looks along it.
  Eigen::Vector2d along() const { return {normal.y(), -normal.x()}; }
  Eigen::Vector2d at(double along_m) const { return offset_m * normal + along_m * along(); }
  double distance_m(const Eigen::Vector2d& point) const { return normal.dot(point) - offset_m; }
  double place_m(const Eigen::Vector2d& point) const { return along().dot(point); }
  // Returns the index of a column; not below columns.size(): there is none.
  std::size_t index_at(double along_m) const;
};

// Returns whether a facet is part of the line's wall.
bool is_of_wall(const WallLine& line, const PlanFacet& facet);

// Returns the lines in the order of their size, the largest first. Turns the surface so that its
// axes are along most of them.
std::vector<WallLine> find_wall_lines(PlanSurface& surface);

// Sets WallLine::passed.
void mark_passed(std::vector<WallLine>& lines, const std::vector<SightLine>& sight_lines);

// How much of a wall a column shows, from 0 to 1. A wall counts as seen where half of its height
// was, since furniture hides the rest. Nothing that ends below the height of a wall counts.
double wall_support(std::uint64_t column, double top_m);

// Returns the mean support along a part of a line.
double wall_support(const WallLine& line, double from_m, double to_m);

}  // namespace hermite::plan
