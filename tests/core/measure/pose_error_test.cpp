#include "core/measure/pose_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/measured_places.h"

namespace hermite::measure {
namespace pose_error_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;

const Vector3d kTowardsCamera(0, 0, -1);

TEST(PoseError, OfADistanceItGrowsWithTheWayBetweenItsEnds) {
  const std::array places{test::place_at({0, 0, 2}, kTowardsCamera),
                          test::place_at({6, 0, 2}, kTowardsCamera)};
  const std::array<Vector3d, 2> gradients{Vector3d(-1, 0, 0), Vector3d(1, 0, 0)};
  const PoseError near = or_throw(pose_error_of(places, gradients, test::seen_from({0, 6}))),
                  far = or_throw(pose_error_of(places, gradients, test::seen_from({0, 3, -6, 6})));
  EXPECT_NEAR(near.way_m, 6, 1e-9);
  EXPECT_NEAR(near.sigma, std::hypot(0.00015, 0.0005 * std::sqrt(6.0)), 1e-9);
  EXPECT_NEAR(far.way_m, 24, 1e-9);
  EXPECT_NEAR(far.sigma, std::hypot(0.00015, 0.0005 * std::sqrt(24.0)), 1e-9);
}

TEST(PoseError, WhatMovingAllPlacesChangesIsNotItsMatter) {
  // The same distance twice over is off by twice as much, and a third place without a derivative
  // adds nothing.
  const std::array places{test::place_at({0, 0, 2}, kTowardsCamera),
                          test::place_at({1, 0, 2}, kTowardsCamera),
                          test::place_at({0.5, 0, 2}, kTowardsCamera)};
  const std::array<Vector3d, 3> once{Vector3d(-1, 0, 0), Vector3d(1, 0, 0), Vector3d::Zero()};
  const std::array<Vector3d, 3> twice{Vector3d(-2, 0, 0), Vector3d(2, 0, 0), Vector3d::Zero()};
  const MapKnowledge map = test::seen_from({0.5});
  EXPECT_NEAR(or_throw(pose_error_of(places, once, map)).sigma, 0.00015, 1e-12);
  EXPECT_NEAR(or_throw(pose_error_of(places, twice, map)).sigma, 0.0003, 1e-12);
}

TEST(PoseError, APathThatIsExpectedToBeWrongMakesItLarger) {
  const std::array places{test::place_at({0, 0, 2}, kTowardsCamera),
                          test::place_at({6, 0, 2}, kTowardsCamera)};
  const std::array<Vector3d, 2> gradients{Vector3d(-1, 0, 0), Vector3d(1, 0, 0)};
  MapKnowledge map = test::seen_from({0, 6});
  const double usual = or_throw(pose_error_of(places, gradients, map)).sigma;
  map.expected_path_m = 0.003;
  EXPECT_EQ(or_throw(pose_error_of(places, gradients, map)).sigma, usual)
      << "as of the scans by which it was measured";
  map.expected_path_m = 0.12;
  EXPECT_NEAR(or_throw(pose_error_of(places, gradients, map)).sigma,
              std::hypot(0.00015, 0.005 * std::sqrt(6.0)), 1e-9);
}

TEST(PoseError, WhatIsNotKnownIsSaidInAMessage) {
  std::array places{test::place_at({0, 0, 2}, kTowardsCamera),
                    test::place_at({0, 0, 9}, kTowardsCamera)};
  const std::array<Vector3d, 2> gradients{kTowardsCamera, -kTowardsCamera};
  EXPECT_THAT(pose_error_of(places, gradients, test::seen_from({0})).error().message,
              HasSubstr("no camera"));
  places[1] = test::place_at({0, 0, 3}, kTowardsCamera);
  places[1].submap = 1;
  MapKnowledge map = test::seen_from({0});
  EXPECT_TRUE(pose_error_of(places, gradients, map).ok()) << "a scan of one part";
  map.part_count = 2;
  EXPECT_THAT(pose_error_of(places, gradients, map).error().message, HasSubstr("2 parts"));
}

TEST(PoseError, ACorrectedCameraIsKnownToItsDeviation) {
  MapKnowledge map = test::seen_from({0});
  const double given = length_share_of(map);
  map.camera_was_corrected = true;
  EXPECT_NEAR(length_share_of(map), std::hypot(given, 0.0015), 1e-12);
}

}  // namespace pose_error_test
}  // namespace hermite::measure
