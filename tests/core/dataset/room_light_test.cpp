#include "core/dataset/room_light.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite {
namespace {

using Eigen::Vector3d;

TEST(RoomLight, DistanceIsOfTheNearestBody) {
  const Furniture bare = furnish(RoomScene::kBare), room = furnish(RoomScene::kRoom);
  EXPECT_NEAR(signed_distance(bare, {0, 0, 1.0}), 1.0, 1e-12);
  EXPECT_NEAR(signed_distance(bare, {0, 0, 2.4}), 0.2, 1e-12);
  EXPECT_NEAR(signed_distance(bare, {2.5, 0, 1}), -0.1, 1e-12);
  EXPECT_NEAR(signed_distance(room, {1.0, 0.7, 0.3}), 0.29, 1e-12) << "above the rug";
  for (const Vector3d& point : {Vector3d(0.3, 0.5, 1.2), Vector3d(-1.5, 1.0, 0.7), Vector3d(1.0, -1.3, 0.5)})
    EXPECT_LE(signed_distance(room, point), signed_distance(bare, point)) << "furniture only takes space away";
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

TEST(RoomLight, SrgbIsClampedAndMonotonic) {
  EXPECT_EQ(srgb_from_linear({-1, 0, 2}), (Rgb8{0, 0, 255}));
  for (int byte = 0; byte < 256; ++byte) {
    const auto value = static_cast<std::uint32_t>(byte);
    const Rgb8 back = srgb_from_linear(linear_from_srgb(value << 16 | value << 8 | value));
    EXPECT_NEAR(back.r, byte, byte < 24 ? 1 : 0) << "the table has 4096 entries";
  }
}

}  // namespace
}  // namespace hermite
