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

// Returns the area that a loop of edges or walls encloses; negative if the loop is clockwise.
template <class Edge>
double area_m2_of(const std::vector<Edge>& loop) {
  double twice_m2 = 0;
  for (const Edge& edge : loop)
    twice_m2 += edge.from_m.x() * edge.to_m.y() - edge.from_m.y() * edge.to_m.x();
  return twice_m2 / 2;
}

}  // namespace hermite::plan
