// What the camera looked through: lines of sight from its places to the surface that it saw. They
// cross rooms, doors and windows, and never a wall. Pure function. Any thread.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/dataset/trajectory.h"
#include "core/plan/plan_frame.h"

namespace hermite::plan {

// In plan coordinates. It ends a little before the surface.
struct SightLine {
  Eigen::Vector3d from_m, to_m;
};

// Computes which facets a camera saw: those within its view that face it, with none before them.
// The poses are those of a result, one for each frame.
std::vector<SightLine> sight_lines_of(const PlanSurface& surface, const dataset::Trajectory& path);

}  // namespace hermite::plan
