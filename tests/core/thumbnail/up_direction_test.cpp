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

constexpr float kDegree = std::numbers::pi_v<float> / 180;

UpDirection measured(const Eigen::Vector3f& up, float sigma_deg) {
  return {up.cast<double>().normalized(), sigma_deg * kDegree};
}

// With a camera on its side the walls are where floors are expected; an accelerometer knows better.
TEST(UpDirection, IsLookedForWhereAnAccelerometerMeasuredIt) {
  const Eigen::Matrix3f world_from_room = turned(5, 90);
  const output::Cloud cloud = room(world_from_room, true);
  const Eigen::Vector3f truth = world_from_room * Eigen::Vector3f(0, -1, 0);
  EXPECT_LT(best_up(cloud, std::nullopt).dot(truth), 0.5f) << "nobody could know";
  const Eigen::Vector3f near = turned(0, 2) * truth;
  EXPECT_GT(best_up(cloud, measured(near, 1)).dot(truth), std::cos(0.5f * kDegree))
      << "the floor is better than the accelerometer";
}

TEST(UpDirection, IsWhatWasMeasuredWhereTheSurfaceDoesNotTell) {
  const Eigen::Vector3f up = turned(20, 130) * Eigen::Vector3f(0, -1, 0);
  EXPECT_LT((best_up({}, measured(up, 1)) - up).norm(), 1e-6f);
  EXPECT_LT((best_up({}, std::nullopt) - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6f);
  // A ramp of 20 degrees is no floor for one who knows up within a degree.
  const Eigen::Vector3f level = turned(20, 0) * Eigen::Vector3f(0, -1, 0);
  EXPECT_LT((best_up(room(turned(0, 0), true), measured(level, 1)) - level).norm(), 1e-6f);
}

TEST(UpDirection, TheRangeIsThreeDeviationsButNotBelowTheSlopeOfAFloor) {
  const UpDirection sharp = measured({0, 0, 1}, 0.1f), wide = measured({0, 0, 1}, 2);
  EXPECT_NEAR(up_range(sharp).most_off_rad, 0.05f, 1e-6f);
  EXPECT_NEAR(up_range(wide).most_off_rad, 6 * kDegree, 1e-6f);
  EXPECT_EQ(up_range(wide).middle, Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(up_range(std::nullopt).middle, UpRange{}.middle);
}

}  // namespace up_direction_test
}  // namespace
}  // namespace hermite::thumbnail
