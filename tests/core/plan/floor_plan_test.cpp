#include "core/plan/floor_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/plan/plan_drawing.h"
#include "tests/support/room_cloud.h"

namespace hermite::plan::floor_plan_test {
namespace {

using test::RoomCloud;

// Wide enough for facets of 2.5 cm; walls are fitted to millimetres.
constexpr double kWall_m = 0.005, kOpening_m = 0.06, kRowsOfOpening_m = 0.15;

Result<FloorPlan> plan_of(const RoomCloud& room) {
  return floor_plan_of({room.cloud(), room.up(), nullptr, nullptr});
}
Result<FloorPlan> seen_plan_of(const RoomCloud& room, const measure::MapKnowledge* map = nullptr) {
  return floor_plan_of({room.cloud(), room.up(), &room.path(), map});
}

std::vector<PlanOpening> openings_of(const PlanRoom& room, OpeningKind kind) {
  std::vector<PlanOpening> openings;
  for (const PlanLoop& loop : room.loops)
    for (const PlanWall& wall : loop)
      std::copy_if(wall.openings.begin(), wall.openings.end(), std::back_inserter(openings),
                   [kind](const PlanOpening& opening) { return opening.kind == kind; });
  return openings;
}

// Lengths of the outer walls, the shortest first.
std::vector<double> lengths_of(const PlanRoom& room) {
  std::vector<double> lengths_m;
  for (const PlanWall& wall : room.loops.front()) lengths_m.push_back(wall.length.length_m);
  std::sort(lengths_m.begin(), lengths_m.end());
  return lengths_m;
}

void look_around(RoomCloud& room, const Eigen::Vector3d& at_m) {
  for (int i = 0; i < 16; ++i)
    room.look(at_m, {std::cos(i * M_PI / 8), std::sin(i * M_PI / 8), i % 2 == 0 ? -0.3 : 0.2});
}

TEST(FloorPlan, FindsTheWallsOfARoomThatIsNotAlongTheAxes) {
  RoomCloud room;
  room.room({0, 4}, {0, 3}, 2.5);
  const Result<FloorPlan> plan = plan_of(room);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  ASSERT_EQ(plan->rooms.size(), 1u);
  const PlanRoom& found = plan->rooms.front();
  EXPECT_THAT(lengths_of(found),
              testing::Pointwise(testing::DoubleNear(kWall_m), {3.0, 3.0, 4.0, 4.0}));
  EXPECT_NEAR(found.area_m2, 12, 0.03);
  ASSERT_TRUE(found.height_m.has_value());
  EXPECT_NEAR(*found.height_m, 2.5, kWall_m);
  EXPECT_TRUE(found.is_closed());
  EXPECT_FALSE(found.area_half_width_m2.has_value()) << "nothing is known of the poses";
  for (const PlanWall& wall : found.loops.front()) {
    EXPECT_TRUE(wall.is_seen);
    EXPECT_TRUE(wall.openings.empty());
    const Eigen::Vector3d corner =
        room.to_room(plan->frame.to_world({wall.from_m.x(), wall.from_m.y(), 0}));
    EXPECT_NEAR(std::min(std::abs(corner.x()), std::abs(corner.x() - 4)), 0, kWall_m);
    EXPECT_NEAR(corner.z(), 0, kWall_m) << "on the floor";
  }
}

TEST(FloorPlan, FindsDoorsAndHolesAndWhatWasNotSeen) {
  RoomCloud room;
  const double x[] = {0, 5}, height = 2.5;
  room.level(0, 1, {x[0], x[1]}, {-0.3, 4});
  room.level(height, -1, {x[0], x[1]}, {0, 4});
  room.wall_x(x[0], 1, {0, 4}, {0, height});
  // A window of 1.2 m by 1 m, and a part behind a wardrobe that the camera never saw.
  room.wall_x(x[1], -1, {0, 4}, {0, height},
              [](double y, double z) { return !(y > 1 && y < 2.2 && z > 0.9 && z < 1.9); });
  room.wall_y(4, -1, {x[0], x[1]}, {0, height},
              [](double along, double z) { return !(along > 2 && along < 3 && z < 2.2); });
  room.wall_y(3.4, -1, {2, 3}, {0, 2.1}), room.wall_x(2, -1, {3.4, 4}, {0, 2.1}),
      room.wall_x(3, 1, {3.4, 4}, {0, 2.1});
  // A door of 0.9 m, through which the floor goes on.
  room.wall_y(0, 1, {x[0], x[1]}, {0, height},
              [](double along, double z) { return !(along > 1 && along < 1.9 && z < 2.05); });
  const Result<FloorPlan> plan = plan_of(room);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  ASSERT_EQ(plan->rooms.size(), 1u);
  const PlanRoom& found = plan->rooms.front();
  EXPECT_NEAR(found.area_m2, 20, 0.05)
      << "the wardrobe is part of the room: the ceiling goes on above it";

  const std::vector<PlanOpening> doors = openings_of(found, OpeningKind::kDoor),
                                 holes = openings_of(found, OpeningKind::kHole),
                                 unseen = openings_of(found, OpeningKind::kUnseen);
  ASSERT_EQ(doors.size(), 1u);
  EXPECT_NEAR(doors[0].to_m - doors[0].from_m, 0.9, kOpening_m);
  EXPECT_NEAR(doors[0].head_m, 2.05, kRowsOfOpening_m);
  ASSERT_EQ(holes.size(), 1u);
  EXPECT_NEAR(holes[0].to_m - holes[0].from_m, 1.2, 2 * kOpening_m);
  EXPECT_NEAR(holes[0].sill_m, 0.9, kRowsOfOpening_m);
  EXPECT_NEAR(holes[0].head_m, 1.9, kRowsOfOpening_m);
  ASSERT_EQ(unseen.size(), 1u);
  EXPECT_NEAR(unseen[0].to_m - unseen[0].from_m, 1, 2 * kOpening_m);
}

TEST(FloorPlan, TellsTwoRoomsApartThatADoorConnects) {
  RoomCloud room;
  const auto with_door = [](double y, double z) { return !(y > 1 && y < 1.9 && z < 2.05); };
  const double height = 2.4;
  for (const auto& [low, high] : {std::pair{0.0, 4.0}, {4.12, 7.0}}) {
    room.level(0, 1, {low, high}, {0, 3}), room.level(height, -1, {low, high}, {0, 3});
    room.wall_y(0, 1, {low, high}, {0, height}), room.wall_y(3, -1, {low, high}, {0, height});
  }
  room.level(0, 1, {4, 4.12}, {1, 1.9});
  room.wall_x(0, 1, {0, 3}, {0, height}), room.wall_x(7, -1, {0, 3}, {0, height});
  room.wall_x(4, -1, {0, 3}, {0, height}, with_door),
      room.wall_x(4.12, 1, {0, 3}, {0, height}, with_door);
  look_around(room, {2, 1.5, 1.5});
  look_around(room, {5.5, 1.5, 1.5});
  const Result<FloorPlan> plan = seen_plan_of(room);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  ASSERT_EQ(plan->rooms.size(), 2u);
  EXPECT_NEAR(plan->rooms[0].area_m2, 12, 0.04);
  EXPECT_NEAR(plan->rooms[1].area_m2, 2.88 * 3, 0.04);
  for (const PlanRoom& found : plan->rooms) {
    const std::vector<PlanOpening> doors = openings_of(found, OpeningKind::kDoor);
    ASSERT_EQ(doors.size(), 1u);
    EXPECT_NEAR(doors[0].to_m - doors[0].from_m, 0.9, kOpening_m);
  }
}

TEST(FloorPlan, SaysNoAreaOfARoomWithoutAWall) {
  RoomCloud room;
  room.level(0, 1, {0, 4}, {0, 3});
  room.wall_x(0, 1, {0, 3}, {0, 2.4}), room.wall_y(0, 1, {0, 4}, {0, 2.4}),
      room.wall_y(3, -1, {0, 4}, {0, 2.4});
  const Result<FloorPlan> plan = plan_of(room);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  ASSERT_EQ(plan->rooms.size(), 1u);
  EXPECT_FALSE(plan->rooms[0].is_closed());
  EXPECT_NEAR(plan->rooms[0].area_m2, 12, 1.5) << "up to the end of what was seen, and a margin";
  EXPECT_THAT(area_text(plan->rooms[0]), testing::HasSubstr("of the outline seen"));
  const PlanLoop& outline = plan->rooms[0].loops.front();
  EXPECT_EQ(std::count_if(outline.begin(), outline.end(),
                          [](const PlanWall& wall) { return !wall.is_seen; }),
            1);
}

TEST(FloorPlan, SaysNoAreaOfGroundThatNobodyLookedAt) {
  // A corridor around a block whose walls were not seen: from outside it looks like one large room.
  RoomCloud room;
  room.wall_x(0, 1, {0, 6}, {0, 2.4}), room.wall_x(8, -1, {0, 6}, {0, 2.4}),
      room.wall_y(0, 1, {0, 8}, {0, 2.4});
  room.wall_y(6, -1, {0, 8}, {0, 2.4});
  room.level(0, 1, {0, 8}, {0, 1.2}), room.level(0, 1, {0, 8}, {4.8, 6}),
      room.level(0, 1, {0, 1.2}, {0, 6});
  room.level(0, 1, {6.8, 8}, {0, 6});
  const Result<FloorPlan> plan = plan_of(room);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  ASSERT_EQ(plan->rooms.size(), 1u);
  EXPECT_GT(plan->rooms[0].seen_share, 0.95);
  EXPECT_FALSE(plan->rooms[0].is_closed());
}

TEST(FloorPlan, TakesOutAColumnThatStandsFree) {
  RoomCloud room;
  room.room({0, 6}, {0, 5}, 2.5);
  room.box({2.5, 3.3}, {2, 2.8}, {0, 2.5});
  look_around(room, {1.2, 1.2, 1.4}), look_around(room, {4.8, 3.8, 1.4}),
      look_around(room, {1.2, 3.8, 1.4}), look_around(room, {4.8, 1.2, 1.4});
  const Result<FloorPlan> plan = seen_plan_of(room);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  ASSERT_EQ(plan->rooms.size(), 1u);
  ASSERT_EQ(plan->rooms[0].loops.size(), 2u);
  EXPECT_NEAR(plan->rooms[0].area_m2, 30 - 0.64, 0.06);
  EXPECT_TRUE(plan->rooms[0].is_closed());
}

TEST(FloorPlan, DrawsAWallThatIsAskew) {
  RoomCloud room;
  for (double y = 0; y < 3; y += 0.1) room.level(0, 1, {0, 4 - (y + 0.05) / 2}, {y, y + 0.1});
  room.wall_x(0, 1, {0, 3}, {0, 2.4}), room.wall_y(0, 1, {0, 4}, {0, 2.4}),
      room.wall_y(3, -1, {0, 2.5}, {0, 2.4});
  // From (4, 0) to (2.5, 3).
  const Eigen::Vector3d normal = Eigen::Vector3d(-3, -1.5, 0).normalized();
  for (double share = 0; share < 1; share += 0.003)
    for (double z = 0.005; z < 2.4; z += 0.01) room.add({4 - 1.5 * share, 3 * share, z}, normal);
  const Result<FloorPlan> plan = plan_of(room);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  ASSERT_EQ(plan->rooms.size(), 1u);
  EXPECT_NEAR(plan->rooms[0].area_m2, 9.75, 0.1);
  EXPECT_THAT(lengths_of(plan->rooms[0]),
              testing::Pointwise(testing::DoubleNear(0.03), {2.5, 3.0, std::hypot(1.5, 3.0), 4.0}));
}

TEST(FloorPlan, LeavesFurnitureIn) {
  RoomCloud room;
  room.room({0, 4}, {0, 3.5}, 2.5);
  room.box({0.05, 0.8}, {0.05, 2}, {0, 0.5});   // a bed
  room.box({1.5, 2.7}, {1.2, 2}, {0.7, 0.75});  // a table
  room.box({3.6, 3.95}, {1, 2}, {0, 1.2});      // a sideboard
  const Result<FloorPlan> plan = plan_of(room);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  ASSERT_EQ(plan->rooms.size(), 1u);
  EXPECT_EQ(plan->rooms[0].loops.front().size(), 4u);
  EXPECT_NEAR(plan->rooms[0].area_m2, 14, 0.04);
}

TEST(FloorPlan, StatesIntervalsThatContainTheTruth) {
  RoomCloud room;
  room.room({0, 4}, {0, 3}, 2.5);
  look_around(room, {2, 1.5, 1.4});
  const measure::MapKnowledge map{measure::CameraWay(room.path()), 1, false};
  const Result<FloorPlan> plan = seen_plan_of(room, &map);
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  const PlanRoom& found = plan->rooms.front();
  ASSERT_TRUE(found.area_half_width_m2.has_value());
  EXPECT_LE(std::abs(found.area_m2 - 12), *found.area_half_width_m2);
  EXPECT_LT(*found.area_half_width_m2, 0.1);
  for (const PlanWall& wall : found.loops.front()) {
    ASSERT_TRUE(wall.length.half_width_m.has_value());
    EXPECT_LE(std::abs(wall.length.length_m - std::round(wall.length.length_m)),
              *wall.length.half_width_m);
    EXPECT_LT(*wall.length.half_width_m, 0.015);
  }
  // Between parts of a map whose relative poses are unknown nothing is stated.
  RoomCloud parts;
  parts.room({0, 4}, {0, 3}, 2.5);
  output::Cloud cloud = parts.cloud();
  for (std::size_t i = 0; i < cloud.size() / 2; ++i) cloud[i].submap = 1;
  const measure::MapKnowledge apart{measure::CameraWay(room.path()), 2, false};
  const Result<FloorPlan> other = floor_plan_of({cloud, parts.up(), &room.path(), &apart});
  ASSERT_TRUE(other.ok());
  EXPECT_FALSE(other->rooms.front().area_half_width_m2.has_value());
}

TEST(FloorPlan, SaysWhatAScanLacks) {
  const auto message_of = [](const output::Cloud& cloud, const Eigen::Vector3d& up) {
    const Result<FloorPlan> plan = floor_plan_of({cloud, up, nullptr, nullptr});
    return plan.ok() ? std::string() : plan.error().message;
  };
  EXPECT_THAT(message_of({}, -Eigen::Vector3d::UnitY()), testing::HasSubstr("no floor"));
  RoomCloud floor;
  floor.level(0, 1, {0, 3}, {0, 3});
  EXPECT_THAT(message_of(floor.cloud(), floor.up()), testing::HasSubstr("no walls"));
  floor.box({1, 2}, {1, 2}, {0, 0.4});
  EXPECT_THAT(message_of(floor.cloud(), floor.up()), testing::HasSubstr("no wall:"))
      << "a box is none";
  RoomCloud far;
  far.room({0, 4}, {0, 3}, 2.5);
  far.add({250, 0, 0}, {0, 0, 1});
  EXPECT_THAT(message_of(far.cloud(), far.up()), testing::HasSubstr("at most 200 m"));
}

TEST(FloorPlan, DamagedPointsAndADistantOriginChangeNothing) {
  RoomCloud room;
  room.room({0, 4}, {0, 3}, 2.5);
  output::Cloud cloud = room.cloud();
  for (output::CloudPoint& point : cloud) point.position_m += Eigen::Vector3f(3000, 0, -2000);
  output::CloudPoint damaged = cloud.front();
  damaged.position_m.x() = std::numeric_limits<float>::quiet_NaN();
  cloud.push_back(damaged);
  damaged.position_m.x() = std::numeric_limits<float>::infinity();
  cloud.push_back(damaged);
  damaged = cloud.front();
  damaged.normal.setZero();
  cloud.push_back(damaged);
  const Result<FloorPlan> plan = floor_plan_of({cloud, room.up(), nullptr, nullptr});
  ASSERT_TRUE(plan.ok()) << plan.error().message;
  EXPECT_NEAR(plan->rooms.front().area_m2, 12, 0.03);
}

}  // namespace
}  // namespace hermite::plan::floor_plan_test
