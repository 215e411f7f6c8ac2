#include <nlohmann/json.hpp>

#include "core/measure/quantity.h"
#include "core/plan/plan_drawing.h"

namespace hermite::plan {

namespace {

using Json = nlohmann::ordered_json;

Json list_of(const Eigen::Vector2d& v) { return Json::array({v.x(), v.y()}); }
Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json wall_json(const PlanWall& wall) {
  Json openings = Json::array();
  for (const PlanOpening& opening : wall.openings)
    openings.push_back({{"kind", name_of(opening.kind)},
                        {"from_m", opening.from_m},
                        {"to_m", opening.to_m},
                        {"sill_m", opening.sill_m},
                        {"head_m", opening.head_m}});
  return {{"from_m", list_of(wall.from_m)},
          {"to_m", list_of(wall.to_m)},
          {"seen", wall.is_seen},
          {"length_m", wall.length.length_m},
          {"length_half_width_m", or_null(wall.length.half_width_m)},
          {"openings", std::move(openings)}};
}

Json room_json(const PlanRoom& room) {
  Json loops = Json::array();
  for (const PlanLoop& loop : room.loops) {
    Json walls = Json::array();
    for (const PlanWall& wall : loop) walls.push_back(wall_json(wall));
    loops.push_back(std::move(walls));
  }
  return {{"area_m2", room.area_m2},
          {"area_half_width_m2", or_null(room.area_half_width_m2)},
          {"closed", room.is_closed()},
          {"seen_share", room.seen_share},
          {"height_m", or_null(room.height_m)},
          {"words", area_text(room)},
          {"outlines", std::move(loops)}};
}

}  // namespace

std::string format_plan_json(const FloorPlan& plan) {
  Json axes = Json::array();
  for (int row = 0; row < 3; ++row) {
    const Eigen::Vector3d axis = plan.frame.plan_from_world.row(row);
    axes.push_back({axis.x(), axis.y(), axis.z()});
  }
  const Eigen::Vector3d& at_m = plan.frame.origin_m;
  Json origin = Json::array({at_m.x(), at_m.y(), at_m.z()});
  Json rooms = Json::array();
  for (const PlanRoom& room : plan.rooms) rooms.push_back(room_json(room));
  const Json json{{"plan_from_world", std::move(axes)},
                  {"origin_m", std::move(origin)},
                  {"confidence", measure::kConfidence},
                  {"rooms", std::move(rooms)}};
  return json.dump(2) + "\n";
}

}  // namespace hermite::plan
