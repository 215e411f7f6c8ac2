#include "core/measure/distance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite {
namespace distance_test {

using ::testing::HasSubstr;

// Seen by a camera at the origin, its error along z.
MeasuredPlace point_at(double x, double z, double sigma_m = 0.001) {
  MeasuredPlace point;
  point.position_m = {x, 0, z};
  point.normal = {0, 0, -1};
  point.normal_sigma_m = sigma_m;
  return point;
}

MapKnowledge seen_from(std::initializer_list<double> xs) {
  Trajectory trajectory;
  for (const double x : xs)
    trajectory.push_back({static_cast<double>(trajectory.size()), Rigid3{Eigen::Quaterniond::Identity(), {x, 0, 0}}});
  return {CameraWay(trajectory), 1, false};
}

double half_width_m(const MeasuredPlace& from, const MeasuredPlace& to, const MapKnowledge& map) {
  const Result<Distance> found = distance_between(from, to, map);
  EXPECT_TRUE(found.ok()) << found.error().message;
  return found.ok() ? found->half_width_m : -1;
}

TEST(Distance, ErrorsAlongTheLineCount) {
  const MapKnowledge map = seen_from({0});
  const Result<Distance> along = distance_between(point_at(0, 2), point_at(0, 3), map);
  ASSERT_TRUE(along.ok());
  EXPECT_DOUBLE_EQ(along->distance_m, 1);
  EXPECT_NEAR(along->surface_sigma_m, 0.001 * std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(along->half_width_m, 1.96 * std::hypot(along->surface_sigma_m, along->pose_sigma_m), 1e-12);
  const Result<Distance> across = distance_between(point_at(-0.5, 2), point_at(0.5, 2), map);
  ASSERT_TRUE(across.ok());
  EXPECT_NEAR(across->surface_sigma_m, 0, 1e-9) << "on one wall";
  EXPECT_LT(across->half_width_m, along->half_width_m);
}

TEST(Distance, ItIsKnownWorseTheFartherTheCameraHasGone) {
  const double near_m = half_width_m(point_at(0, 2), point_at(1, 2), seen_from({0.5}));
  const double far_m = half_width_m(point_at(0, 2), point_at(1, 2), seen_from({-1, -5, 2.1}));
  EXPECT_GT(far_m, 1.5 * near_m);
}

TEST(Distance, ACorrectedCameraIsKnownToItsDeviation) {
  MapKnowledge map = seen_from({0});
  const double given_m = half_width_m(point_at(-1, 3), point_at(1, 3), map);
  map.camera_was_corrected = true;
  EXPECT_NEAR(half_width_m(point_at(-1, 3), point_at(1, 3), map), std::hypot(given_m, 1.96 * 0.0015 * 2), 1e-6);
}

TEST(Distance, WhatCannotBeMeasuredIsSaidInWords) {
  MapKnowledge map = seen_from({0});
  const auto words = [&](const MeasuredPlace& from, const MeasuredPlace& to) {
    const Result<Distance> found = distance_between(from, to, map);
    return found.ok() ? std::string() : found.error().message;
  };
  EXPECT_THAT(words(point_at(0, 2), point_at(0, 2)), HasSubstr("same place"));
  EXPECT_THAT(words(point_at(0, 2), point_at(0, 9)), HasSubstr("no camera"));
  MeasuredPlace elsewhere = point_at(0, 3);
  elsewhere.submap = 1;
  EXPECT_EQ(words(point_at(0, 2), elsewhere), "") << "a scan of one part";
  map.part_count = 2;
  EXPECT_THAT(words(point_at(0, 2), elsewhere), HasSubstr("2 parts"));
  EXPECT_EQ(words(point_at(0, 2), point_at(0, 3)), "");
}

TEST(Distance, WordsRoundTheHalfWidthUp) {
  Distance distance;
  distance.distance_m = 1.2341;
  distance.half_width_m = 0.0021;
  EXPECT_EQ(words_of(distance), "1.234 m ± 0.003 m (95 %)");
}

}  // namespace distance_test
}  // namespace hermite
