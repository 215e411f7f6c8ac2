#include "core/dataset/camera_velocity.h"

#include <gtest/gtest.h>

namespace hermite::dataset {
namespace {

const Vector6d kTwist_per_s = (Vector6d() << 0.3, -0.1, 0.2, 0.4, 0.6, -0.5).finished();

// A camera that moves steadily from a pose that is not the origin.
Trajectory steady(const std::vector<double>& times_s) {
  const Rigid3 start = exp_se3((Vector6d() << 1, 2, 3, 0.5, -0.7, 0.2).finished());
  Trajectory trajectory;
  for (const double time_s : times_s)
    trajectory.push_back({time_s, start * exp_se3(time_s * kTwist_per_s)});
  return trajectory;
}

TEST(CameraVelocity, TheTwistIsThatOfTheCameraInItsOwnFrame) {
  const Trajectory trajectory = steady({0, 0.033, 0.066, 0.3});
  for (const double time_s : {0.0, 0.033, 0.066}) {
    const std::optional<Vector6d> twist_per_s = twist_per_s_at(trajectory, time_s);
    ASSERT_TRUE(twist_per_s.has_value()) << time_s;
    EXPECT_LT((*twist_per_s - kTwist_per_s).norm(), 1e-9) << time_s;
  }
}

TEST(CameraVelocity, WithoutANearPoseThereIsNoTwist) {
  EXPECT_FALSE(twist_per_s_at(steady({0, 0.033, 0.066, 0.3}), 0.3)) << "the pose before is too old";
  EXPECT_FALSE(twist_per_s_at(steady({0, 0.033}), 0.016)) << "no pose at that time";
  EXPECT_FALSE(twist_per_s_at(steady({0}), 0));
  EXPECT_FALSE(twist_per_s_at({}, 0));
}

}  // namespace
}  // namespace hermite::dataset
