// The boundaries of rooms as loops of straight edges. Pure function. Any thread.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/plan/plan_cells.h"

namespace hermite::plan {

struct OutlineEdge {
  Eigen::Vector2d from_m, to_m;  // the room is on the left
  int line = kNoLine;
  bool faces_it = false;  // the room is on the side of the line from which its wall was seen
};
using OutlineLoop = std::vector<OutlineEdge>;  // each edge ends where the next one begins

// Returns the loops of one room: the one around it first, counter-clockwise, then those of what
// stands free in it, clockwise.
std::vector<OutlineLoop> outlines_of(const PlanCells& plan, int room);

// The enclosed area; negative if the loop is clockwise.
double area_m2_of(const OutlineLoop& loop);

}  // namespace hermite::plan
