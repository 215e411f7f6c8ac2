#include "core/plan/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/measure/quantity.h"
#include "core/plan/plan_cells.h"
#include "core/plan/room_outlines.h"
#include "core/plan/wall_fit.h"
#include "core/plan/wall_openings.h"

namespace hermite::plan {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// What is smaller is a cupboard, or the space behind one.
constexpr double kLeastRoom_m2 = 1, kLeastRoomWidth_m = 0.6;
constexpr double kClosedShare = 0.8, kClosedGround = 0.8;
// A jog between two walls that was not seen itself is somewhere within this; a longer part of the
// outline may be anywhere.
constexpr double kJogSigma_m = 0.05, kLongestJog_m = 0.5;
constexpr double kMostSkew_rad = 0.05;  // a wall that is turned by more is meant to be
constexpr double kLeastStep_m = 0.01;
// Greatest cosine between the directions of walls whose distance is a length.
constexpr double kPerpendicular = 0.3;
constexpr double kLeastRoomCeiling_m2 = 0.5;
constexpr int kLabelSteps = 48;

// A wall with what its errors are computed from.
struct WallOfRoom {
  FittedWall fit;
  OutlineEdge edge;
  Vector2d from_m, to_m;
  double length_m() const { return (to_m - from_m).norm(); }
};
using WallsOfRoom = std::vector<WallOfRoom>;

void find_corners(WallsOfRoom& walls) {
  for (std::size_t i = 0; i < walls.size(); ++i) {
    WallOfRoom &last = walls[(i + walls.size() - 1) % walls.size()], &wall = walls[i];
    wall.from_m = last.to_m = corner_of(last.fit, wall.fit, wall.edge.from_m);
  }
}

// Two lines along one wall that is not quite straight have a step between them, which vanishes when
// both are fitted: the shorter part goes with it. False: there is none.
bool drop_shortest(WallsOfRoom& walls) {
  if (walls.size() <= 4) return false;
  const auto shorter = [](const WallOfRoom& a, const WallOfRoom& b) {
    return a.length_m() < b.length_m();
  };
  const auto step = std::min_element(walls.begin(), walls.end(), shorter);
  if (step->length_m() >= kLeastStep_m) return false;
  const auto index = static_cast<std::size_t>(step - walls.begin());
  const std::size_t last = (index + walls.size() - 1) % walls.size(),
                    next = (index + 1) % walls.size();
  std::array gone{index, shorter(walls[last], walls[next]) ? last : next};
  std::sort(gone.begin(), gone.end());
  walls.erase(walls.begin() + static_cast<std::ptrdiff_t>(gone[1]));
  walls.erase(walls.begin() + static_cast<std::ptrdiff_t>(gone[0]));
  return true;
}

WallsOfRoom walls_of(const OutlineLoop& loop, const std::vector<WallLine>& lines,
                     const PlanSurface& surface) {
  WallsOfRoom walls;
  for (const OutlineEdge& edge : loop)
    walls.push_back({edge.line == kNoLine
                         ? unseen_wall(edge)
                         : fit_wall(edge, lines[static_cast<std::size_t>(edge.line)],
                                    surface.facets, surface.frame),
                     edge, edge.from_m, edge.to_m});
  find_corners(walls);
  while (drop_shortest(walls)) find_corners(walls);
  return walls;
}

Vector3d to_world(const PlanFrame& frame, const Vector2d& direction) {
  return frame.plan_from_world.transpose() * Vector3d(direction.x(), direction.y(), 0);
}

// The RMS distance of a wall from one along the nearest axis of the plan. A room may have such
// walls, but a scan that is bent shows them, too, and does not say which it is.
double skew_m(const WallOfRoom& wall) {
  const double turn_rad =
      std::remainder(std::atan2(wall.fit.normal.y(), wall.fit.normal.x()), M_PI / 2);
  if (std::abs(turn_rad) > kMostSkew_rad) return 0;
  return wall.length_m() * std::abs(turn_rad) / std::sqrt(12.0);
}

std::optional<double> half_width_of_length(const WallOfRoom& wall, const WallOfRoom& before,
                                           const WallOfRoom& after, const PlanFrame& frame,
                                           const measure::MapKnowledge* map) {
  if (!map || !before.fit.place || !after.fit.place || !wall.fit.place) return std::nullopt;
  const Vector2d along = (wall.to_m - wall.from_m).normalized();
  if (std::abs(before.fit.normal.dot(along)) < 1 - kPerpendicular ||
      std::abs(after.fit.normal.dot(along)) < 1 - kPerpendicular)
    return std::nullopt;
  const std::array places{*before.fit.place, *after.fit.place};
  const std::array<Vector3d, 2> gradients{-to_world(frame, along), to_world(frame, along)};
  const Result<measure::PoseError> drift = measure::pose_error_of(places, gradients, *map);
  if (!drift.ok()) return std::nullopt;
  const double surface_m = std::hypot(std::hypot(places[0].normal_sigma_m, skew_m(before)),
                                      std::hypot(places[1].normal_sigma_m, skew_m(after)));
  return measure::kDeviationsOfConfidence *
         std::hypot(surface_m, drift->sigma, measure::length_share_of(*map) * wall.length_m());
}

// A wall that moves into the room takes its length from the area.
std::optional<double> half_width_of_area(const std::vector<WallsOfRoom>& loops, double area_m2,
                                         const PlanFrame& frame, const measure::MapKnowledge* map) {
  if (!map) return std::nullopt;
  std::vector<measure::MeasuredPlace> places;
  std::vector<Vector3d> gradients;
  Vector3d unseen = Vector3d::Zero();
  double squares = 0;
  for (const WallsOfRoom& walls : loops)
    for (const WallOfRoom& wall : walls) {
      const Vector3d gradient = -wall.length_m() * to_world(frame, wall.fit.normal);
      if (wall.fit.place) {
        places.push_back(*wall.fit.place);
        gradients.push_back(gradient);
        squares +=
            std::pow(wall.length_m() * std::hypot(wall.fit.place->normal_sigma_m, skew_m(wall)), 2);
      } else {
        if (wall.length_m() > kLongestJog_m) return std::nullopt;
        unseen += gradient;
        squares += std::pow(wall.length_m() * kJogSigma_m, 2);
      }
    }
  if (places.size() < 2) return std::nullopt;
  Vector3d sum = unseen;
  for (const Vector3d& gradient : gradients) sum += gradient;
  gradients.front() += unseen - sum;  // all walls together do not change the area
  const Result<measure::PoseError> drift = measure::pose_error_of(places, gradients, *map);
  if (!drift.ok()) return std::nullopt;
  return measure::kDeviationsOfConfidence *
         std::hypot(std::sqrt(squares), drift->sigma, 2 * measure::length_share_of(*map) * area_m2);
}

PlanLoop loop_of(const WallsOfRoom& walls, const std::vector<WallLine>& lines,
                 const PlanSurface& surface, const measure::MapKnowledge* map) {
  PlanLoop loop;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const WallOfRoom& wall = walls[i];
    PlanWall result;
    result.from_m = wall.from_m;
    result.to_m = wall.to_m;
    result.is_seen = wall.fit.place.has_value();
    result.length = {wall.length_m(),
                     half_width_of_length(wall, walls[(i + walls.size() - 1) % walls.size()],
                                          walls[(i + 1) % walls.size()], surface.frame, map)};
    if (result.is_seen)
      result.openings = openings_of({wall.from_m, wall.to_m, wall.edge.line, true},
                                    lines[static_cast<std::size_t>(wall.edge.line)], surface.facets,
                                    surface.frame.top_m);
    loop.push_back(std::move(result));
  }
  return loop;
}

double ground_share_of(const PlanCells& cells, int room) {
  double seen_m2 = 0, all_m2 = 0;
  for (const PlanCell& cell : cells.cells) {
    if (cell.room != room) continue;
    seen_m2 += cell.seen_m2;
    all_m2 += cell.area_m2;
  }
  return all_m2 > 0 ? seen_m2 / all_m2 : 0;
}

double seen_share_of(const std::vector<PlanLoop>& loops) {
  double seen_m = 0, all_m = 0;
  for (const PlanLoop& loop : loops)
    for (const PlanWall& wall : loop) {
      all_m += wall.length.length_m;
      if (!wall.is_seen) continue;
      seen_m += wall.length.length_m;
      for (const PlanOpening& opening : wall.openings)
        if (opening.kind == OpeningKind::kUnseen) seen_m -= opening.to_m - opening.from_m;
    }
  return all_m > 0 ? std::clamp(seen_m / all_m, 0.0, 1.0) : 0;
}

// Even-odd rule.
bool is_within(const std::vector<PlanLoop>& loops, const Vector2d& at_m) {
  bool inside = false;
  for (const PlanLoop& loop : loops)
    for (const PlanWall& wall : loop) {
      const Vector2d &a = wall.from_m, &b = wall.to_m;
      if ((a.y() > at_m.y()) == (b.y() > at_m.y())) continue;
      if (at_m.x() < a.x() + (b.x() - a.x()) * (at_m.y() - a.y()) / (b.y() - a.y()))
        inside = !inside;
    }
  return inside;
}

double distance_to_walls_m(const std::vector<PlanLoop>& loops, const Vector2d& at_m) {
  double nearest_m = 1e9;
  for (const PlanLoop& loop : loops)
    for (const PlanWall& wall : loop) {
      const Vector2d along = wall.to_m - wall.from_m;
      const double share = std::clamp(
          (at_m - wall.from_m).dot(along) / std::max(1e-9, along.squaredNorm()), 0.0, 1.0);
      nearest_m = std::min(nearest_m, (at_m - wall.from_m - share * along).norm());
    }
  return nearest_m;
}

// The place on a grid that is farthest from all walls, and near the middle of a corridor.
Vector2d label_place(const std::vector<PlanLoop>& loops) {
  Vector2d low_m = loops.front().front().from_m, high_m = low_m;
  for (const PlanWall& wall : loops.front()) {
    low_m = low_m.cwiseMin(wall.from_m);
    high_m = high_m.cwiseMax(wall.from_m);
  }
  constexpr double kOffMiddle = 0.05;
  const Vector2d middle_m = 0.5 * (low_m + high_m);
  Vector2d best_m = middle_m;
  double best_score_m = -1e9;
  for (int i = 1; i < kLabelSteps; ++i)
    for (int j = 1; j < kLabelSteps; ++j) {
      const Vector2d at_m = low_m + (high_m - low_m).cwiseProduct(Vector2d(i, j) / kLabelSteps);
      if (!is_within(loops, at_m)) continue;
      const double score_m =
          distance_to_walls_m(loops, at_m) - kOffMiddle * (at_m - middle_m).norm();
      if (score_m <= best_score_m) continue;
      best_score_m = score_m;
      best_m = at_m;
    }
  return best_m;
}

// The median height of what faces down over the room, near the ceiling of the scan.
std::optional<double> height_of(const PlanRoom& room, const PlanSurface& surface) {
  if (!surface.frame.has_ceiling) return std::nullopt;
  constexpr double kNearCeiling_m = 0.3;
  std::vector<double> heights_m;
  for (const PlanFacet& facet : surface.facets)
    if (facet.normal.z() < -kLevelCosine &&
        std::abs(facet.at_m.z() - surface.frame.top_m) < kNearCeiling_m &&
        is_within(room.loops, facet.at_m.head<2>()))
      heights_m.push_back(facet.at_m.z());
  if (static_cast<double>(heights_m.size()) * kFacet_m * kFacet_m < kLeastRoomCeiling_m2)
    return std::nullopt;
  const auto middle = heights_m.begin() + static_cast<std::ptrdiff_t>(heights_m.size() / 2);
  std::nth_element(heights_m.begin(), middle, heights_m.end());
  return *middle;
}

}  // namespace

const char* name_of(OpeningKind kind) {
  switch (kind) {
    case OpeningKind::kDoor: return "door";
    case OpeningKind::kHole: return "hole";
    case OpeningKind::kUnseen: return "unseen";
  }
  CHECK(false, "an opening has one of the kinds");
}

bool PlanRoom::is_closed() const {
  return seen_share >= kClosedShare && ground_share >= kClosedGround;
}

Result<FloorPlan> floor_plan_of(const PlanSource& source) {
  Result<PlanSurface> surface = plan_surface_of(source.cloud, source.up);
  if (!surface.ok()) return surface.error();
  std::vector<WallLine> lines = find_wall_lines(*surface);
  if (lines.empty())
    return Error{ErrorCode::kInvalidArgument,
                 "the scan shows no wall: no upright plane is as high and long as one"};
  const std::vector<SightLine> sight_lines =
      source.path ? sight_lines_of(*surface, *source.path) : std::vector<SightLine>();
  mark_passed(lines, sight_lines);
  const Result<PlanCells> cells = plan_cells_of(*surface, lines, sight_lines);
  if (!cells.ok()) return cells.error();
  FloorPlan plan;
  plan.frame = surface->frame;
  for (int index = 0; index < cells->room_count; ++index) {
    std::vector<WallsOfRoom> walls;
    PlanRoom room;
    for (const OutlineLoop& loop : outlines_of(*cells, index)) {
      walls.push_back(walls_of(loop, lines, *surface));
      room.loops.push_back(loop_of(walls.back(), lines, *surface, source.map));
      room.area_m2 += area_m2_of(room.loops.back());
    }
    if (room.area_m2 < kLeastRoom_m2) continue;
    room.seen_share = seen_share_of(room.loops);
    room.ground_share = ground_share_of(*cells, index);
    if (room.is_closed())
      room.area_half_width_m2 = half_width_of_area(walls, room.area_m2, surface->frame, source.map);
    room.height_m = height_of(room, *surface);
    room.label_at_m = label_place(room.loops);
    if (distance_to_walls_m(room.loops, room.label_at_m) < kLeastRoomWidth_m / 2) continue;
    plan.rooms.push_back(std::move(room));
  }
  if (plan.rooms.empty())
    return Error{ErrorCode::kInvalidArgument,
                 "the scan shows no room: its walls enclose no square metre of what was seen"};
  std::stable_sort(plan.rooms.begin(), plan.rooms.end(),
                   [](const PlanRoom& a, const PlanRoom& b) { return a.area_m2 > b.area_m2; });
  return plan;
}

}  // namespace hermite::plan
