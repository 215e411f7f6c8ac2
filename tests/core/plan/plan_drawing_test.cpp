#include "core/plan/plan_drawing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

namespace hermite::plan::plan_drawing_test {
namespace {

using testing::HasSubstr;
using testing::Not;

// A room of 4 by 3 m with a door, a hole, and a part that was not seen; the last wall was not seen
// at all.
FloorPlan example() {
  PlanRoom room;
  const std::array<Eigen::Vector2d, 4> corners{{{0, 0}, {4, 0}, {4, 3}, {0, 3}}};
  PlanLoop loop;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    PlanWall wall;
    wall.from_m = corners[i];
    wall.to_m = corners[(i + 1) % corners.size()];
    wall.is_seen = i != 3;
    wall.length = {(wall.to_m - wall.from_m).norm(), 0.004};
    loop.push_back(wall);
  }
  loop[0].openings = {{OpeningKind::kDoor, 1, 1.9, 0, 2.05}};
  loop[1].openings = {{OpeningKind::kHole, 0.5, 1.5, 0.9, 1.9}};
  loop[2].openings = {{OpeningKind::kUnseen, 3, 4, 0, 2.5}};
  room.loops = {loop};
  room.area_m2 = 12;
  room.area_half_width_m2 = 0.0412;
  room.seen_share = room.ground_share = 0.9;
  room.height_m = 2.5;
  room.label_at_m = {2, 1.5};
  FloorPlan plan;
  plan.rooms = {room};
  return plan;
}

// Code and value of each group.
std::vector<std::pair<int, std::string>> groups_of(const std::string& dxf) {
  std::vector<std::pair<int, std::string>> groups;
  std::istringstream lines(dxf);
  for (std::string code, value; std::getline(lines, code) && std::getline(lines, value);) {
    EXPECT_EQ(code.back(), '\r');
    EXPECT_EQ(value.back(), '\r');
    value.pop_back();
    groups.emplace_back(std::atoi(code.c_str()), value);
  }
  return groups;
}

TEST(PlanDrawing, DividesAWallAtItsOpenings) {
  PlanWall wall;
  wall.length.length_m = 4;
  wall.openings = {{OpeningKind::kHole, -0.2, 0.5, 1, 2},
                   {OpeningKind::kDoor, 1, 2, 0, 2},
                   {OpeningKind::kUnseen, 1.5, 9, 0, 2}};
  const std::vector<WallPart> parts = parts_of(wall);
  ASSERT_EQ(parts.size(), 4u);
  EXPECT_EQ(parts[0].opening, &wall.openings[0]);
  EXPECT_EQ(parts[1].opening, nullptr);
  EXPECT_EQ(parts[2].opening, &wall.openings[1]);
  EXPECT_EQ(parts[3].opening, &wall.openings[2]);
  double at_m = 0;
  for (const WallPart& part : parts) {
    EXPECT_EQ(part.from_m, at_m) << "without gaps and overlaps";
    at_m = part.to_m;
  }
  EXPECT_EQ(at_m, 4);
}

TEST(PlanDrawing, SaysWhatIsKnownOfAnArea) {
  PlanRoom room = example().rooms.front();
  EXPECT_EQ(area_text(room), "12.00 m² ± 0.05 m²") << "rounded up";
  room.area_half_width_m2.reset();
  EXPECT_EQ(area_text(room), "12.00 m²");
  room.seen_share = 0.5;
  EXPECT_EQ(area_text(room), "about 12.0 m² (50 % of the outline seen)");
}

TEST(PlanDrawing, IsOnPaperAtAScale) {
  const std::string svg = format_plan_svg(example());
  EXPECT_THAT(svg, HasSubstr("1:20, lengths in metres")) << "3 m are 150 mm";
  EXPECT_THAT(svg, HasSubstr(">Room 1<"));
  EXPECT_THAT(svg, HasSubstr(">12.00 m² ± 0.05 m²<"));
  EXPECT_THAT(svg, HasSubstr(">height 2.50 m<"));
  EXPECT_THAT(svg, HasSubstr(">3.000<"));
  EXPECT_THAT(svg, Not(HasSubstr(">4.000<"))) << "where these walls end was not seen";
  EXPECT_THAT(svg, HasSubstr(">0.90<")) << "the width of the door";
  EXPECT_THAT(svg, HasSubstr("class=\"unseen\""));
}

TEST(PlanDrawing, IsADrawingInMetresForOtherPrograms) {
  const auto groups = groups_of(format_plan_dxf(example()));
  ASSERT_FALSE(groups.empty());
  EXPECT_EQ(groups.back(), std::pair(0, std::string("EOF")));
  std::map<std::string, double> length_m;  // by layer
  double x[2] = {}, y[2] = {};
  std::string entity, layer;
  for (const auto& [code, value] : groups) {
    if (code == 0) {
      if (entity == "LINE") length_m[layer] += std::hypot(x[1] - x[0], y[1] - y[0]);
      entity = value;
    }
    if (code == 8) layer = value;
    if (code == 10 || code == 11) x[code - 10] = std::atof(value.c_str());
    if (code == 20 || code == 21) y[code - 20] = std::atof(value.c_str());
    if (code == 1 && entity == "TEXT") {
      EXPECT_TRUE(value == "Room 1" || value == "12.00 m2 %%p 0.05 m2") << value;
    }
  }
  EXPECT_NEAR(length_m["WALLS"], 14 - 3 - 0.9 - 1 - 1, 1e-6);
  EXPECT_NEAR(length_m["DOORS"], 0.9, 1e-6);
  EXPECT_NEAR(length_m["HOLES"], 1, 1e-6);
  EXPECT_NEAR(length_m["UNSEEN"], 4, 1e-6) << "a part of one wall, and another wall";
}

TEST(PlanDrawing, IsNumbers) {
  const nlohmann::json json = nlohmann::json::parse(format_plan_json(example()));
  const nlohmann::json& room = json["rooms"][0];
  EXPECT_EQ(room["area_m2"], 12.0);
  EXPECT_EQ(room["area_half_width_m2"], 0.0412);
  EXPECT_EQ(room["closed"], true);
  EXPECT_EQ(room["outlines"][0][0]["openings"][0]["kind"], "door");
  EXPECT_EQ(room["outlines"][0][3]["seen"], false);
  EXPECT_EQ(json["plan_from_world"].size(), 3u);
}

}  // namespace
}  // namespace hermite::plan::plan_drawing_test
