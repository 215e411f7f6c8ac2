#include "core/thumbnail/up_direction.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace hermite::thumbnail {
namespace {
namespace up_direction_test {

// The surface of a box seen from inside, turned, with noise on its normals.
output::Cloud room(const Eigen::Matrix3f& world_from_room, bool with_floor) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 0.03f);
  output::Cloud cloud;
  const auto add = [&](const Eigen::Vector3f& normal, int count) {
    for (int i = 0; i < count; ++i) {
      output::CloudPoint point;
      point.normal =
          world_from_room *
          (normal + Eigen::Vector3f(noise(random), noise(random), noise(random))).normalized();
      cloud.push_back(point);
    }
  };
  if (with_floor) add({0, -1, 0}, 2000);
  add({1, 0, 0}, 1500);
  add({0, 0, -1}, 2500);
  return cloud;
}

Eigen::Matrix3f turned(float pitch_deg, float roll_deg) {
  constexpr float kRad = std::numbers::pi_v<float> / 180;
  return (Eigen::AngleAxisf(pitch_deg * kRad, Eigen::Vector3f::UnitX()) *
          Eigen::AngleAxisf(roll_deg * kRad, Eigen::Vector3f::UnitZ()))
      .toRotationMatrix();
}

TEST(UpDirection, OfARoomIsAcrossItsFloorHoweverTheCameraWasHeld) {
  for (const float pitch_deg : {0.0f, -33.0f, 40.0f})
    for (const float roll_deg : {0.0f, 12.0f}) {
      const Eigen::Matrix3f world_from_room = turned(pitch_deg, roll_deg);
      const std::optional<Eigen::Vector3f> up = up_direction(room(world_from_room, true));
      ASSERT_TRUE(up.has_value()) << pitch_deg << " " << roll_deg;
      EXPECT_NEAR(up->norm(), 1, 1e-5f);
      EXPECT_GT(up->dot(world_from_room * Eigen::Vector3f(0, -1, 0)), std::cos(0.02f))
          << pitch_deg << " " << roll_deg;
    }
}

TEST(UpDirection, IsNotKnownOfWallsAloneOfAFewPointsAndOfABall) {
  EXPECT_FALSE(up_direction(room(turned(0, 0), false)).has_value());
  EXPECT_FALSE(up_direction({}).has_value());
  EXPECT_FALSE(up_direction(output::Cloud(100000)).has_value());  // without normals
  std::mt19937 random(2);
  std::normal_distribution<float> value;
  output::Cloud ball(5000);
  for (output::CloudPoint& point : ball)
    point.normal = Eigen::Vector3f(value(random), value(random), value(random)).normalized();
  EXPECT_FALSE(up_direction(ball).has_value());
}

}  // namespace up_direction_test
}  // namespace
}  // namespace hermite::thumbnail
