// A floor plan of a scan: its rooms with their walls, openings, areas and heights, each with what
// is known of its error. Pure functions. Any thread.
//
// Walls are found as upright planes (wall_lines.h), rooms as what they enclose (plan_cells.h). Then
// each wall is fitted again to the surface along its own part of the outline, and its error is
// computed as that of any plane of core/measure; areas and lengths have intervals that contain the
// truth with the probability kConfidence.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/measure/pose_error.h"
#include "core/output/cloud.h"
#include "core/plan/plan_frame.h"

namespace hermite::plan {

enum class OpeningKind : std::uint8_t {
  // Nothing of the wall up to the height of a man, and the camera looked through it or saw the
  // floor go on.
  kDoor,
  // Nothing of the wall was seen, though it was on all sides of it: a window, a mirror, or
  // something black.
  kHole,
  kUnseen,  // the wall was not scanned there, or something stands before it
};
const char* name_of(OpeningKind kind);  // "door", "hole", "unseen"

// A part of a wall, from left to right seen from the room.
struct PlanOpening {
  OpeningKind kind = OpeningKind::kDoor;
  double from_m = 0, to_m = 0;  // from the start of the wall
  // Heights above the floor; of what is unseen 0 and the height of the room.
  double sill_m = 0, head_m = 0;
};

struct PlanLength {
  double length_m = 0;
  std::optional<double> half_width_m;  // none: nothing is known of the error
};

struct PlanWall {
  // Corners, in plan coordinates.
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero(), to_m = Eigen::Vector2d::Zero();
  bool is_seen = false;  // false: nothing of it was, and the room may go on there
  // Length between the walls at its ends; has no interval where one of them is not seen or parallel
  // to it.
  PlanLength length;
  std::vector<PlanOpening> openings;
};
// Each wall ends where the next one begins, with the room on the left.
using PlanLoop = std::vector<PlanWall>;

struct PlanRoom {
  // The one around the room, and those of what stands free in it up to the height of a wall.
  std::vector<PlanLoop> loops;
  double area_m2 = 0;
  // None: nothing is known of the error, or parts of the outline were not seen.
  std::optional<double> area_half_width_m2;
  // Share of the outline that was seen: of its walls and their doors and holes.
  double seen_share = 0;
  // Share of the area over which the camera looked or saw something level.
  double ground_share = 0;
  // Height of the ceiling above the floor, if both were seen.
  std::optional<double> height_m;
  Eigen::Vector2d label_at_m = Eigen::Vector2d::Zero();  // a place inside, far from the walls

  // Nearly all of its outline and of its ground was seen, so that its area is that of the room.
  bool is_closed() const;
};

struct FloorPlan {
  PlanFrame frame;
  std::vector<PlanRoom> rooms;  // the largest first
};

// A finished scan, in whose world `up` is a unit vector. Without `path` and `map`, which may be
// null, plans have no intervals, and openings are found by the floor behind them alone.
struct PlanSource {
  const output::Cloud& cloud;
  Eigen::Vector3d up;
  const dataset::Trajectory* path = nullptr;  // a pose for each frame
  const measure::MapKnowledge* map = nullptr;
};

// Returns the plan of a scan. kInvalidArgument when there is no floor, no wall or no room;
// kTooLarge as plan_surface_of and plan_cells_of.
Result<FloorPlan> floor_plan_of(const PlanSource& source);

}  // namespace hermite::plan
