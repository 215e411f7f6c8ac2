#include "core/plan/wall_openings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace hermite::plan {

namespace {

// A wall may be seen this far behind its line, as a closed door or a window pane in a reveal.
constexpr double kReveal_m = 0.25, kAcross = 0.8;
// What stands before a wall, within this, hides it.
constexpr double kHidesFrom_m = 0.06, kHidesTo_m = 1.0;
// Heights between which a doorway is free of walls, but for a row of noise.
constexpr double kFreeFrom_m = 0.2, kFreeTo_m = 1.6;
constexpr double kTable_m = 0.8;
constexpr int kNoiseRows = 1;
constexpr double kLeastDoor_m = 0.5, kLeastHole_m = 0.4, kLeastUnseen_m = 0.15;
constexpr double kFloorShare = 0.5;  // of a doorway, behind which the floor was seen
constexpr double kHoleFill = 0.6;    // of its rectangle is empty
constexpr double kMostHidden = 0.3;  // of a hole
constexpr int kJoinedColumns = 2;    // columns of noise in a gap
constexpr double kSeen = 0.5;

struct Grid {
  int columns = 0, rows = 0;
  std::vector<bool> wall, hidden;      // by column and row
  std::vector<std::uint64_t> heights;  // of each column, as of WallLine
  std::vector<bool> floor_behind;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(column * rows + row);
  }
};

// Whether the camera looked through at the height of tables and of more than half of a door:
// windows are higher, and hatches lower.
bool is_doorway(std::uint64_t passed) {
  const auto rows = [](double from_m, double to_m) {
    const auto below = [](double height_m) {
      return (std::uint64_t{1} << static_cast<int>(height_m / kRow_m)) - 1;
    };
    return below(to_m) & ~below(from_m);
  };
  return (passed & rows(0, kTable_m)) != 0 && (passed & rows(kTable_m, 2 * kTable_m)) != 0;
}

Grid grid_of(const WallLine& line, double from_m, double to_m, std::span<const PlanFacet> facets,
             double top_m) {
  Grid grid;
  grid.columns = std::max(1, static_cast<int>((to_m - from_m) / kColumn_m));
  grid.rows = std::clamp(static_cast<int>(top_m / kRow_m), 1, 64);
  grid.wall.resize(static_cast<std::size_t>(grid.columns * grid.rows));
  grid.hidden = grid.wall;
  grid.heights.resize(static_cast<std::size_t>(grid.columns));
  grid.floor_behind.resize(static_cast<std::size_t>(grid.columns));
  for (const PlanFacet& facet : facets) {
    const Eigen::Vector2d at_m = facet.at_m.head<2>();
    const double off_m = line.distance_m(at_m),
                 column = std::floor((line.place_m(at_m) - from_m) / kColumn_m);
    if (off_m < -kReveal_m || off_m > kHidesTo_m || column < 0 || column >= grid.columns) continue;
    const double row = std::floor(facet.at_m.z() / kRow_m);
    if (row < 0 || row >= grid.rows) continue;
    const std::size_t index = grid.index(static_cast<int>(column), static_cast<int>(row));
    if (off_m > kHidesFrom_m) grid.hidden[index] = true;
    if (off_m > kWallBand_m || std::abs(facet.normal.z()) >= kUpright ||
        std::abs(facet.normal.head<2>().dot(line.normal)) < kAcross)
      continue;
    grid.wall[index] = true;
    grid.heights[static_cast<std::size_t>(column)] |= std::uint64_t{1} << static_cast<int>(row);
  }
  for (int column = 0; column < grid.columns; ++column) {
    const std::size_t of_line = line.index_at(from_m + (column + 0.5) * kColumn_m);
    grid.floor_behind[static_cast<std::size_t>(column)] =
        of_line < line.columns.size() &&
        (line.floor_behind[of_line] || is_doorway(line.passed[of_line]));
  }
  return grid;
}

struct Run {
  int first, end;  // columns
};

// Returns the longest stretches of columns for which `holds`, over short interruptions.
template <class Holds>
std::vector<Run> runs_of(int columns, const Holds& holds) {
  std::vector<Run> runs;
  for (int column = 0; column < columns; ++column) {
    if (!holds(column)) continue;
    if (!runs.empty() && column - runs.back().end <= kJoinedColumns)
      runs.back().end = column + 1;
    else
      runs.push_back({column, column + 1});
  }
  return runs;
}

bool is_free(const Grid& grid, int column) {
  int filled = 0;
  for (int row = static_cast<int>(kFreeFrom_m / kRow_m);
       row < std::min(grid.rows, static_cast<int>(kFreeTo_m / kRow_m)); ++row)
    filled += grid.wall[grid.index(column, row)] ? 1 : 0;
  return filled <= kNoiseRows;
}

// The height of the lowest surface above a gap, in most of its columns.
double head_m(const Grid& grid, Run run) {
  std::vector<double> heads_m;
  for (int column = run.first; column < run.end; ++column) {
    int row = static_cast<int>(kFreeTo_m / kRow_m);
    while (row < grid.rows && !grid.wall[grid.index(column, row)]) ++row;
    heads_m.push_back(std::min(row, grid.rows) * kRow_m);
  }
  const auto middle = heads_m.begin() + static_cast<std::ptrdiff_t>(heads_m.size() / 2);
  std::nth_element(heads_m.begin(), middle, heads_m.end());
  return *middle;
}

// The end columns of a doorway may be partly filled by its frame: the surface of the wall nearest
// to it ends it.
std::pair<double, double> exact_ends_m(const WallLine& line, double from_m, Run run,
                                       std::span<const PlanFacet> facets) {
  const double low_m = from_m + run.first * kColumn_m, high_m = from_m + run.end * kColumn_m,
               middle_m = 0.5 * (low_m + high_m);
  constexpr double kBeside_m = 0.1;
  double left_m = low_m - kBeside_m, right_m = high_m + kBeside_m;
  for (const PlanFacet& facet : facets) {
    if (!is_of_wall(line, facet) || facet.at_m.z() < kFreeFrom_m || facet.at_m.z() > kFreeTo_m)
      continue;
    const double place_m = line.place_m(facet.at_m.head<2>());
    if (place_m < middle_m && place_m <= low_m + kColumn_m) left_m = std::max(left_m, place_m);
    if (place_m > middle_m && place_m >= high_m - kColumn_m) right_m = std::min(right_m, place_m);
  }
  return {left_m, right_m};
}

std::vector<PlanOpening> doors_of(const Grid& grid, const WallLine& line, double from_m,
                                  std::span<const PlanFacet> facets) {
  std::vector<PlanOpening> doors;
  if (grid.rows < static_cast<int>(kFreeTo_m / kRow_m)) return doors;
  for (const Run& gap : runs_of(grid.columns, [&](int column) { return is_free(grid, column); })) {
    for (Run run : runs_of(gap.end - gap.first, [&](int column) {
           return grid.floor_behind[static_cast<std::size_t>(gap.first + column)];
         })) {
      run = {run.first + gap.first, run.end + gap.first};
      // To the ends of the gap, if the floor is hidden only there.
      if (run.first - gap.first <= kJoinedColumns) run.first = gap.first;
      if (gap.end - run.end <= kJoinedColumns) run.end = gap.end;
      int floors = 0;
      for (int column = run.first; column < run.end; ++column)
        floors += grid.floor_behind[static_cast<std::size_t>(column)] ? 1 : 0;
      if (floors < kFloorShare * (run.end - run.first)) continue;
      const auto [left_m, right_m] = exact_ends_m(line, from_m, run, facets);
      if (right_m - left_m < kLeastDoor_m) continue;
      doors.push_back(
          {OpeningKind::kDoor, left_m - from_m, right_m - from_m, 0, head_m(grid, run)});
    }
  }
  return doors;
}

// Rectangles without any wall, which have wall on all sides and nothing before them.
std::vector<PlanOpening> holes_of(const Grid& grid) {
  std::vector<PlanOpening> holes;
  std::vector<bool> reached(grid.wall);
  for (int start = 0; start < grid.columns * grid.rows; ++start) {
    if (reached[static_cast<std::size_t>(start)]) continue;
    int left = grid.columns, right = -1, low = grid.rows, high = -1, count = 0, hidden = 0;
    std::vector<int> next{start};
    reached[static_cast<std::size_t>(start)] = true;
    while (!next.empty()) {
      const int column = next.back() / grid.rows, row = next.back() % grid.rows;
      next.pop_back();
      ++count;
      hidden += grid.hidden[grid.index(column, row)] ? 1 : 0;
      left = std::min(left, column), right = std::max(right, column), low = std::min(low, row),
      high = std::max(high, row);
      for (const auto& [aside, above] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int to_column = column + aside, to_row = row + above;
        if (to_column < 0 || to_column >= grid.columns || to_row < 0 || to_row >= grid.rows)
          continue;
        const std::size_t beside = grid.index(to_column, to_row);
        if (reached[beside]) continue;
        reached[beside] = true;
        next.push_back(static_cast<int>(beside));
      }
    }
    const int width = right - left + 1, height = high - low + 1;
    const bool is_enclosed =
        left > 0 && right < grid.columns - 1 && low * kRow_m >= kFreeFrom_m && high < grid.rows - 1;
    if (!is_enclosed || width * kColumn_m < kLeastHole_m || height * kRow_m < kLeastHole_m ||
        count < kHoleFill * width * height || hidden > kMostHidden * count)
      continue;
    holes.push_back({OpeningKind::kHole, left * kColumn_m, (right + 1) * kColumn_m, low * kRow_m,
                     (high + 1) * kRow_m});
  }
  return holes;
}

}  // namespace

std::vector<PlanOpening> openings_of(const OutlineEdge& edge, const WallLine& line,
                                     std::span<const PlanFacet> facets, double top_m) {
  const double from_m = line.place_m(edge.from_m), to_m = line.place_m(edge.to_m);
  const Grid grid = grid_of(line, from_m, to_m, facets, top_m);
  std::vector<PlanOpening> openings = doors_of(grid, line, from_m, facets);
  for (const PlanOpening& hole : holes_of(grid)) openings.push_back(hole);
  const auto is_open = [&openings](double along_m) {
    return std::any_of(openings.begin(), openings.end(), [along_m](const PlanOpening& opening) {
      return along_m > opening.from_m && along_m < opening.to_m;
    });
  };
  std::vector<PlanOpening> unseen;
  for (const Run& run : runs_of(grid.columns, [&](int column) {
         return !is_open((column + 0.5) * kColumn_m) &&
                wall_support(grid.heights[static_cast<std::size_t>(column)], top_m) < kSeen;
       }))
    if ((run.end - run.first) * kColumn_m >= kLeastUnseen_m)
      unseen.push_back(
          {OpeningKind::kUnseen, run.first * kColumn_m, run.end * kColumn_m, 0, top_m});
  openings.insert(openings.end(), unseen.begin(), unseen.end());
  std::sort(openings.begin(), openings.end(),
            [](const PlanOpening& a, const PlanOpening& b) { return a.from_m < b.from_m; });
  return openings;
}

}  // namespace hermite::plan
