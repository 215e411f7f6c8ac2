#include "core/synthetic/room_light.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

TEST(RoomLight, DistanceIsOfTheNearestBody) {
  const Furniture bare = furnish(RoomScene::kBare), room = furnish(RoomScene::kRoom);
  EXPECT_NEAR(signed_distance(bare, {0, 0, 1.0}), 1.0, 1e-12);
  EXPECT_NEAR(signed_distance(bare, {0, 0, 2.4}), 0.2, 1e-12);
  EXPECT_NEAR(signed_distance(bare, {2.5, 0, 1}), -0.1, 1e-12);
  EXPECT_NEAR(signed_distance(room, {1.0, 0.7, 0.3}), 0.29, 1e-12) << "above the rug";
  for (const Vector3d& point :
       {Vector3d(0.3, 0.5, 1.2), Vector3d(-1.5, 1.0, 0.7), Vector3d(1.0, -1.3, 0.5)})
    EXPECT_LE(signed_distance(room, point), signed_distance(bare, point))
        << "furniture only takes space away";
}

TEST(RoomLight, CornersAreDarkerAndEverythingIsLit) {
  const Furniture room = furnish(RoomScene::kRoom);
  const RoomLight light(room);
  const float open = light.at({0.8, 0.7, 0.01}, Vector3d::UnitZ()).mean(),
              under_the_desk = light.at({-0.5, -1.8, 0.0}, Vector3d::UnitZ()).mean();
  EXPECT_LT(under_the_desk, 0.7f * open);
  EXPECT_GT(under_the_desk, 0.05f);
  EXPECT_LT(open, 1.5f);
}

Furniture two_zones(float apart_m) {
  Furniture scene;
  scene.shapes.push_back(
      {ShapeKind::kRoom, {4, 2, 1.3}, Eigen::Matrix3d::Identity(), {0, 0, 1.3}, 0});
  scene.lights.push_back({{-4, -2}, {-apart_m, 2}, {-2, 0, 2.3f}, {-2, 0, 2.3f}, {-4, 0, 1.7f}});
  scene.lights.push_back({{apart_m, -2}, {4, 2}, {2, 0, 2.3f}, {2, 0, 2.3f}, {4, 0, 1.7f}});
  return scene;
}

TEST(RoomLight, AZoneIsLitByItsOwnLampOnly) {
  Furniture scene = two_zones(0.06f);
  const Vector3d floor(-1, 0.5, 0);
  const Eigen::Vector3f before = RoomLight(scene).at(floor, Vector3d::UnitZ());
  scene.lights[1].lamp_from_m = scene.lights[1].lamp_to_m = {0.1f, 0, 1};
  EXPECT_EQ(RoomLight(scene).at(floor, Vector3d::UnitZ()), before);
  EXPECT_NE(RoomLight(scene).at({1, 0.5, 0}, Vector3d::UnitZ()), before);
}

TEST(RoomLight, WhereZonesOverlapLightPassesWithoutASeam) {
  const Furniture scene = two_zones(-0.8f);
  const RoomLight light(scene);
  const auto largest_step = [&](double step_m) {
    double largest = 0;
    for (double x = -1.5; x < 1.5; x += step_m) {
      const Eigen::Vector3f difference = light.at({x, 0.5, 0}, Vector3d::UnitZ()) -
                                         light.at({x + step_m, 0.5, 0}, Vector3d::UnitZ());
      largest = std::max(largest, static_cast<double>(difference.cwiseAbs().maxCoeff()));
    }
    return largest;
  };
  EXPECT_LT(largest_step(0.002), 0.2 * largest_step(0.02))
      << "a seam would be as high from near as from far";
}

TEST(RoomLight, ATubeLightsEvenlyAlongItself) {
  Furniture scene = two_zones(0);
  scene.lights = {{{-4, -2}, {4, 2}, {-3, 0, 2.3f}, {3, 0, 2.3f}, {0, 100, 1.7f}}};
  const RoomLight light(scene);
  EXPECT_NEAR(light.at({-2, 0, 0}, Vector3d::UnitZ()).x(),
              light.at({1, 0, 0}, Vector3d::UnitZ()).x(), 1e-3);
}

TEST(RoomLight, TheScenesOfManyRoomsAreLitEverywhere) {
  const Furniture loop = furnish(RoomScene::kLoop);
  const RoomLight light(loop);
  for (const Vector3d& place : {Vector3d(-3, 1, 0.006), Vector3d(3, 1, 0.006), Vector3d(0, -1.3, 0),
                                Vector3d(4, -1.06, 0.006)}) {
    ASSERT_NEAR(signed_distance(loop, place), 0, 0.02);
    EXPECT_GT(light.at(place, Vector3d::UnitZ()).minCoeff(), 0.2f);
    EXPECT_LT(light.at(place, Vector3d::UnitZ()).maxCoeff(), 1.5f);
  }
}

TEST(RoomLight, SrgbIsClampedAndMonotonic) {
  EXPECT_EQ(srgb_from_linear({-1, 0, 2}), (Rgb8{0, 0, 255}));
  for (int byte = 0; byte < 256; ++byte) {
    const auto value = static_cast<std::uint32_t>(byte);
    const Rgb8 back = srgb_from_linear(linear_from_srgb(value << 16 | value << 8 | value));
    EXPECT_NEAR(back.r, byte, byte < 24 ? 1 : 0) << "the table has 4096 entries";
  }
}

}  // namespace
}  // namespace hermite::synthetic
