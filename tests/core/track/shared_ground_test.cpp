#include "core/track/shared_ground.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/coarse_wall.h"

namespace hermite::track::shared_ground_test {
namespace {

using test::coarse_wall;

Rigid3 beside(double x_m) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, 0, 0)}; }

TEST(SharedGround, ThinnedViewsShowTheSamePlaces) {
  frame::CoarseMask left(4800, 0);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i % 80 < 40 ? 1 : 0;
  const frame::CoarseView whole = coarse_wall(2), thin = thinned(whole, left);
  ASSERT_EQ(thin.size(), 1200u);
  EXPECT_EQ(thin.depth_m[thin.index(19, 5)], 0) << "what moves is left out";
  EXPECT_TRUE(thin.point(30, 20).isApprox(whole.point(60, 40), 1e-6));
}

TEST(SharedGround, APointMeetsTheSurfaceItLiesOn) {
  const frame::CoarseView view = coarse_wall(2), other = coarse_wall(1.99), far = coarse_wall(1.5);
  GroundMeeting meeting;
  ASSERT_TRUE(SharedGround(view, beside(0.1), other, {}).meet(40, 30, meeting));
  EXPECT_NEAR(meeting.distance_m, 0.01, 1e-6);
  EXPECT_TRUE(meeting.point.isApprox(beside(0.1) * view.point(40, 30), 1e-9));
  EXPECT_TRUE(meeting.normal.isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_FALSE(SharedGround(view, {}, far, {}).meet(40, 30, meeting)) << "another surface";
  EXPECT_FALSE(SharedGround(view, beside(5), other, {}).meet(40, 30, meeting))
      << "beside the image";
  EXPECT_FALSE(SharedGround(view, beside(5), other, {}).may_meet());
  EXPECT_TRUE(SharedGround(view, beside(0.1), other, {}).may_meet());
}

TEST(SharedGround, SaysWhatAWrongCameraDoes) {
  const frame::CoarseView view = coarse_wall(2);
  GroundMeeting meeting;
  ASSERT_TRUE(SharedGround(view, beside(0.4), view, {}).meet(10, 29, meeting));
  // Seen in the corner and in the middle: farther away by the share of the squared distances; a
  // longer focal length shifts neither in depth.
  const double now = std::pow((10 - 39.5) / 39.5, 2), earlier = std::pow((23 - 39.5) / 39.5, 2),
               corner = 1 + std::pow(29.5 / 39.5, 2);
  EXPECT_NEAR(meeting.off_by_camera(2, kBendDoubt), 2 * (now - earlier) / corner, 0.03);
  EXPECT_NEAR(meeting.off_by_camera(2, kFocalDoubt), 0, 1e-9);
}

TEST(SharedGround, TooLittleInCommonSaysNothing) {
  const frame::CoarseView view = coarse_wall(2);
  EXPECT_TRUE(camera_terms(SharedGround(view, beside(2.2), view, {})).information.isZero());
  // Nor does a wall whose motion along itself is free.
  EXPECT_TRUE(camera_terms(SharedGround(view, {}, view, {})).information.isZero());
}

}  // namespace
}  // namespace hermite::track::shared_ground_test
