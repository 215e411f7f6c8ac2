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

}  // namespace
}  // namespace hermite::track
