#include "core/synthetic/world_walls.h"

#include <gtest/gtest.h>

#include "core/synthetic/room_light.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

constexpr double kExact_m = 1e-12;

// Two rooms beside each other with a door at y = 0.5.
Furniture two_rooms() {
  const Area west{{-3.0, -0.06}, {-1.0, 2.0}}, east{{0.06, 3.0}, {-1.0, 2.0}};
  Furnisher f;
  const Paint paint{Pattern::kPaint, 0xffffff, 0xeeeeee};
  add_shell(f, {west, east}, {paint, paint, paint});
  const AreaLook look{{0, 1, 2, 3}, 4, 5};
  add_area(f, west, look, {{Side::kEast, 0.5}});
  add_area(f, east, look, {{Side::kWest, 0.5}});
  return std::move(f.out);
}

TEST(WorldWalls, DistancesInFreeSpaceAreThoseToTheNearestFace) {
  const Furniture rooms = two_rooms();
  EXPECT_NEAR(signed_distance(rooms, {-1.5, 0.5, 1.2}), 1.194, kExact_m)
      << "the floor is 6 mm thick";
  EXPECT_NEAR(signed_distance(rooms, {-0.36, -0.6, 1.3}), 0.3, kExact_m) << "the wall between";
  EXPECT_NEAR(signed_distance(rooms, {0.36, -0.6, 1.3}), 0.3, kExact_m) << "and its other side";
  EXPECT_NEAR(signed_distance(rooms, {-2.8, 1.0, 1.3}), 0.2, kExact_m) << "an outer wall";
  EXPECT_NEAR(signed_distance(rooms, {1.5, 1.0, 2.5}), 0.1, kExact_m) << "the ceiling";
}

TEST(WorldWalls, PointsSunkIntoAWallKnowHowFar) {
  const Furniture rooms = two_rooms();
  for (const double depth_m : {0.003, 0.02, 0.05}) {
    EXPECT_NEAR(signed_distance(rooms, {-0.06 + depth_m, -0.6, 1.3}), -depth_m, kExact_m);
    EXPECT_NEAR(signed_distance(rooms, {0.06 - depth_m, -0.6, 1.3}), -depth_m, kExact_m);
    EXPECT_NEAR(signed_distance(rooms, {-3.0 - depth_m, 1.0, 1.3}), -depth_m, kExact_m);
    EXPECT_NEAR(signed_distance(rooms, {1.5, 1.0, 0.006 - depth_m}), -depth_m, kExact_m);
  }
}

TEST(WorldWalls, ADoorIsFreeWithinItsFrame) {
  const Furniture rooms = two_rooms();
  EXPECT_NEAR(signed_distance(rooms, {0, 0.5, 1.2}), kDoor_m / 2 - 0.015, kExact_m)
      << "half the opening without the frame's lining";
  EXPECT_NEAR(signed_distance(rooms, {0, 0.5, 1.9}), kDoorTop_m - 0.015 - 1.9, kExact_m);
  EXPECT_LT(signed_distance(rooms, {0, 0.5, 2.2}), 0) << "a wall above";
  EXPECT_LT(signed_distance(rooms, {0, -0.5, 1.2}), 0) << "and beside it";
}

TEST(WorldWalls, NoRayLeavesThePlan) {
  const Furniture rooms = two_rooms();
  const Vector3d eye(-1.0, 0.5, 1.2);
  for (int i = 0; i < 360; ++i) {
    const double angle = i * M_PI / 180;
    const Vector3d direction(std::cos(angle), std::sin(angle), 0.1 * std::sin(7 * angle));
    double nearest_m = 1e9;
    for (const Shape& shape : rooms.shapes)
      nearest_m = std::min(
          nearest_m, intersect(shape, shape.world_from_shape.transpose() * (eye - shape.center),
                               shape.world_from_shape.transpose() * direction, 0));
    const Vector3d end = eye + nearest_m * direction;
    EXPECT_NEAR(signed_distance(rooms, end), 0, 1e-9) << i;
    EXPECT_LT(end.cwiseAbs().maxCoeff(), 3.001);
  }
}

TEST(WorldWalls, APieceForTheNorthWallStandsOnEveryWall) {
  const Area area{{-2, 2}, {-1, 1}};
  for (const Side side : {Side::kNorth, Side::kWest, Side::kSouth, Side::kEast}) {
    Furnisher f;
    f.box({-0.1, 0.1}, {-0.3, 0}, {0, 1}, 0);
    move_group(f.out, 0, f.count(),
               {Eigen::Vector2d::Zero(), at_wall(area, side, 0.4), static_cast<int>(side)});
    Furnisher expected;
    on_wall(expected, {area, side}, {{0.3, 0.5}, {0, 0.3}, {0, 1}}, 0);
    const Shape &moved = f.out.shapes[0], &built = expected.out.shapes[0];
    EXPECT_LT((moved.center - built.center).norm(), kExact_m);
    EXPECT_LT(((moved.world_from_shape * moved.size).cwiseAbs() - built.size).norm(), kExact_m);
  }
}

}  // namespace
}  // namespace hermite::synthetic
