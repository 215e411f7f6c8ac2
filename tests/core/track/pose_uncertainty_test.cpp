#include "core/track/pose_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::track {
namespace {

TEST(PoseUncertainty, GrowsByTheStepsOfDepth) {
  const PoseUncertainty before{1e-4 * Matrix6d::Identity(), 0, 0, {}};
  const PoseUncertainty after = with_steps(before, {2, 0.05, 0.03});
  EXPECT_NEAR(after.position_sigma_m(), std::hypot(0.01, 0.03), 1e-9);
  EXPECT_NEAR(after.rotation_sigma_rad(), std::hypot(0.01, 0.03 / 2), 1e-9) << "seen from 2 m";
  EXPECT_EQ(with_steps(before, {}).position_sigma_m(), before.position_sigma_m()) << "unknown";
}

TEST(PoseUncertainty, GrowsByAnErrorWhereTheCameraIs) {
  const PoseUncertainty before{1e-4 * Matrix6d::Identity(), 0, 0, {}};
  const Vector6d turn = (Vector6d() << 0, 0, 0, 0, 0, 0.02).finished();
  EXPECT_NEAR(with_error(before, turn, {1, 0, 0}).position_sigma_m(), std::hypot(0.01, 0.02), 1e-9)
      << "turning about the world's origin moves a camera one metre away";
  EXPECT_NEAR(with_error(before, turn, {0, 0, 0}).position_sigma_m(), 0.01, 1e-9);
  EXPECT_NEAR(with_error(before, turn, {0, 0, 0}).rotation_sigma_rad(), std::hypot(0.01, 0.02),
              1e-9);
}

}  // namespace
}  // namespace hermite::track
