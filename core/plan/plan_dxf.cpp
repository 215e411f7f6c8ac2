#include <fmt/core.h>

#include <cstring>
#include <string>
#include <utility>

#include "core/base/printf_text.h"
#include "core/plan/plan_drawing.h"

namespace hermite::plan {

namespace {

using Eigen::Vector2d;

struct DxfLayer {
  const char* name;
  int color;  // of the AutoCAD colour index
};
constexpr DxfLayer kWalls{"WALLS", 7}, kDoors{"DOORS", 3}, kHoles{"HOLES", 5}, kUnseen{"UNSEEN", 8},
    kText{"TEXT", 2};
constexpr int kMetre = 6;  // of $INSUNITS
constexpr double kTextHeight_m = 0.15;

std::string group(int code, const std::string& value) {
  return fmt::format("{:3}\r\n{}\r\n", code, value);
}
std::string place(int code, const Vector2d& at_m) {
  return group(code, printf_text("%.6f", at_m.x())) +
         group(code + 10, printf_text("%.6f", at_m.y())) + group(code + 20, "0.0");
}
std::string section(const char* name, const std::string& content) {
  return group(0, "SECTION") + group(2, name) + content + group(0, "ENDSEC");
}
std::string table(const char* name, int rows, const std::string& content) {
  return group(0, "TABLE") + group(2, name) + group(70, std::to_string(rows)) + content +
         group(0, "ENDTAB");
}

std::string layers() {
  std::string rows;
  for (const DxfLayer& layer : {kWalls, kDoors, kHoles, kUnseen, kText})
    rows += group(0, "LAYER") + group(2, layer.name) + group(70, "0") +
            group(62, std::to_string(layer.color)) + group(6, "CONTINUOUS");
  const std::string solid = group(0, "LTYPE") + group(2, "CONTINUOUS") + group(70, "0") +
                            group(3, "Solid line") + group(72, "65") + group(73, "0") +
                            group(40, "0.0");
  return table("LTYPE", 1, solid) + table("LAYER", 5, rows);
}

// The format has ASCII only; %%p is its sign for plus or minus.
std::string in_ascii(std::string text) {
  for (const auto& [sign, ascii] : {std::pair{"²", "2"}, {"±", "%%p"}})
    for (std::size_t at = text.find(sign); at != std::string::npos; at = text.find(sign))
      text.replace(at, std::strlen(sign), ascii);
  return text;
}

std::string words(const Vector2d& at_m, const std::string& text) {
  return group(0, "TEXT") + group(8, kText.name) + place(10, at_m) +
         group(40, printf_text("%g", kTextHeight_m)) + group(1, text);
}

const DxfLayer& layer_of(const PlanWall& wall, const WallPart& part) {
  if (!wall.is_seen) return kUnseen;
  if (!part.opening) return kWalls;
  switch (part.opening->kind) {
    case OpeningKind::kDoor: return kDoors;
    case OpeningKind::kHole: return kHoles;
    case OpeningKind::kUnseen: return kUnseen;
  }
  return kUnseen;
}

std::string entities(const FloorPlan& plan) {
  std::string text;
  for (std::size_t i = 0; i < plan.rooms.size(); ++i) {
    const PlanRoom& room = plan.rooms[i];
    for (const PlanLoop& loop : room.loops)
      for (const PlanWall& wall : loop) {
        const Vector2d along = (wall.to_m - wall.from_m).normalized();
        for (const WallPart& part : parts_of(wall))
          text += group(0, "LINE") + group(8, layer_of(wall, part).name) +
                  place(10, wall.from_m + part.from_m * along) +
                  place(11, wall.from_m + part.to_m * along);
      }
    const std::string area = in_ascii(area_text(room));
    text += words(room.label_at_m, "Room " + std::to_string(i + 1)) +
            words(room.label_at_m - Vector2d(0, 1.6 * kTextHeight_m), area);
  }
  return text;
}

}  // namespace

std::string format_plan_dxf(const FloorPlan& plan) {
  const std::string header = group(9, "$ACADVER") + group(1, "AC1009") + group(9, "$INSUNITS") +
                             group(70, std::to_string(kMetre));
  return group(999, "Floor plan in metres") + section("HEADER", header) +
         section("TABLES", layers()) + section("ENTITIES", entities(plan)) + group(0, "EOF");
}

}  // namespace hermite::plan
