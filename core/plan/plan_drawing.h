// A floor plan as files: a drawing on paper, a drawing for CAD programs, and numbers. Pure
// functions. Any thread.
#pragma once

#include <string>

#include "core/plan/floor_plan.h"

namespace hermite::plan {

// SVG in millimetres on paper, at the largest of the usual scales at which the plan fits on an A3,
// with a bar to check a print by. Walls are thick lines, holes double ones, doors thin ones with
// their width, and what was not seen dashed.
std::string format_plan_svg(const FloorPlan& plan);

// DXF as release 12 has it, which all programs read, in metres. Layers: WALLS, DOORS, HOLES, UNSEEN
// and TEXT.
std::string format_plan_dxf(const FloorPlan& plan);

// One object with the frame, and the rooms with all of their walls, openings, areas and intervals
// (core/output/README.md).
std::string format_plan_json(const FloorPlan& plan);

// The parts of a wall between its openings, and the openings, from its start to its end.
struct WallPart {
  double from_m = 0, to_m = 0;
  const PlanOpening* opening = nullptr;  // null: wall
};
std::vector<WallPart> parts_of(const PlanWall& wall);

// "19.94 m² ± 0.05 m²"; "about 19.9 m² (72 % of the outline seen)" if it is not closed.
std::string area_text(const PlanRoom& room);

}  // namespace hermite::plan
