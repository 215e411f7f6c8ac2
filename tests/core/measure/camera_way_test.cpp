#include "core/measure/camera_way.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::measure {
namespace camera_way_test {

const Eigen::Vector3d kTowardsCamera(0, 0, -1);

// Ten metres along x, a pose every 10 cm, looking along z.
dataset::Trajectory along_x() {
  dataset::Trajectory trajectory;
  for (int i = 0; i <= 100; ++i)
    trajectory.push_back({0.1 * i, Rigid3{Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}}});
  return trajectory;
}

// The first of the places faces the camera.
double between_m(const CameraWay& way, const Eigen::Vector3d& place,
                 const Eigen::Vector3d& other_place,
                 const Eigen::Vector3d& other_normal = kTowardsCamera) {
  return way.between_m(way.seen_from(place, kTowardsCamera),
                       way.seen_from(other_place, other_normal));
}

TEST(CameraWay, PlacesThatOneCameraHasSeenHaveNoneBetweenThem) {
  const CameraWay way(along_x());
  EXPECT_EQ(between_m(way, {3, 0, 2}, {4, 0, 2}), 0);
}

TEST(CameraWay, ItIsTheLeastBetweenThoseThatHaveSeenEither) {
  const CameraWay way(along_x());
  const double half_view_m = 2 * std::tan(38 * M_PI / 180);
  const double expected_m = 6 - 2 * half_view_m;
  EXPECT_NEAR(between_m(way, {2, 0, 2}, {8, 0, 2}), expected_m, 0.2);
  EXPECT_NEAR(between_m(way, {8, 0, 2}, {2, 0, 2}), expected_m, 0.2);
}

TEST(CameraWay, WhatNoneHasSeenIsInfinitelyFar) {
  const CameraWay way(along_x());
  EXPECT_TRUE(std::isinf(between_m(way, {2, 0, 2}, {2, 0, -2}))) << "behind";
  EXPECT_TRUE(std::isinf(between_m(way, {2, 0, 2}, {2, 0, 2}, -kTowardsCamera))) << "its back";
  EXPECT_TRUE(std::isinf(between_m(CameraWay({}), {2, 0, 2}, {2, 0, 2})));
}

}  // namespace camera_way_test
}  // namespace hermite::measure
