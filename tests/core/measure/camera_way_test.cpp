#include "core/measure/camera_way.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite {
namespace camera_way_test {

const Eigen::Vector3d kTowardsCamera(0, 0, -1);

// Ten metres along x, a pose every 10 cm, looking along z.
Trajectory along_x() {
  Trajectory trajectory;
  for (int i = 0; i <= 100; ++i) trajectory.push_back({0.1 * i, Rigid3{Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}}});
  return trajectory;
}

TEST(CameraWay, PlacesThatOneCameraHasSeenHaveNoneBetweenThem) {
  const CameraWay way(along_x());
  EXPECT_EQ(way.between_m({3, 0, 2}, kTowardsCamera, {4, 0, 2}, kTowardsCamera), 0);
}

TEST(CameraWay, ItIsTheLeastBetweenThoseThatHaveSeenEither) {
  const CameraWay way(along_x());
  const double half_view_m = 2 * std::tan(38 * M_PI / 180);
  const double expected_m = 6 - 2 * half_view_m;
  EXPECT_NEAR(way.between_m({2, 0, 2}, kTowardsCamera, {8, 0, 2}, kTowardsCamera), expected_m, 0.2);
  EXPECT_NEAR(way.between_m({8, 0, 2}, kTowardsCamera, {2, 0, 2}, kTowardsCamera), expected_m, 0.2);
}

TEST(CameraWay, WhatNoneHasSeenIsInfinitelyFar) {
  const CameraWay way(along_x());
  EXPECT_TRUE(std::isinf(way.between_m({2, 0, 2}, kTowardsCamera, {2, 0, -2}, kTowardsCamera))) << "behind";
  EXPECT_TRUE(std::isinf(way.between_m({2, 0, 2}, kTowardsCamera, {2, 0, 2}, -kTowardsCamera))) << "its back";
  EXPECT_TRUE(std::isinf(CameraWay({}).between_m({2, 0, 2}, kTowardsCamera, {2, 0, 2}, kTowardsCamera)));
}

}  // namespace camera_way_test
}  // namespace hermite
