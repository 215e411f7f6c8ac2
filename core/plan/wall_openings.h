// The parts of a wall where nothing of it was seen, and what they are. Pure function. Any thread.
#pragma once

#include <span>
#include <vector>

#include "core/plan/floor_plan.h"
#include "core/plan/room_outlines.h"

namespace hermite::plan {

// Returns the openings of an edge that faces its line, from its start, without overlaps; `facets`
// are those of the whole scan.
std::vector<PlanOpening> openings_of(const OutlineEdge& edge, const WallLine& line,
                                     std::span<const PlanFacet> facets, double top_m);

}  // namespace hermite::plan
