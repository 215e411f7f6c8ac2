// A wall of a room fitted to the surface along it. Pure functions. Any thread.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "core/measure/surface_fit.h"
#include "core/plan/room_outlines.h"

namespace hermite::plan {

struct FittedWall {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // unit, towards the room, in plan coordinates
  double offset_m = 0;                                // normal.dot(point) of its points
  // The place of its surface that is nearest to the middle of the edge, with the wall's normal and
  // its standard deviation, in the world of the scan; none: the wall was not seen along the edge.
  std::optional<measure::MeasuredPlace> place;
};

// Fits the wall of an edge that lies on a line. The facets are those of the whole scan.
FittedWall fit_wall(const OutlineEdge& edge, const WallLine& line,
                    std::span<const PlanFacet> facets, const PlanFrame& frame);

// Returns the wall of an edge that nothing was seen of.
FittedWall unseen_wall(const OutlineEdge& edge);

// Returns where two walls meet; `otherwise` if they are nearly parallel.
Eigen::Vector2d corner_of(const FittedWall& first, const FittedWall& second,
                          const Eigen::Vector2d& otherwise);

}  // namespace hermite::plan
