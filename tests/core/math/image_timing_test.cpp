#include "core/math/image_timing.h"

#include <gtest/gtest.h>

namespace hermite {
namespace {

TEST(ImageTiming, RowsAreSharesOfTheReadout) {
  EXPECT_EQ(share_of_row(0, 481), -0.5);
  EXPECT_EQ(share_of_row(240, 481), 0);
  EXPECT_EQ(share_of_row(480, 481), 0.5);
}

TEST(ImageTiming, RowsAreTakenAroundTheTimeStampAndColourLater) {
  const ImageTiming timing{0.020, 0.030, 0.005};
  EXPECT_DOUBLE_EQ(timing.depth_time_s(0, 481), -0.010);
  EXPECT_DOUBLE_EQ(timing.color_time_s(240, 481), 0.005);
  EXPECT_DOUBLE_EQ(timing.color_time_s(480, 481), 0.020);
}

TEST(ImageTiming, TheVelocityOfAPointIsTheDerivativeOfItsMovement) {
  const Vector6d twist_per_s = (Vector6d() << 0.3, -0.1, 0.2, 0.4, 0.6, -0.5).finished();
  const Eigen::Vector3d point_m(0.4, -0.3, 2);
  constexpr double kStep_s = 1e-6;
  const Eigen::Vector3d moved_m = exp_se3(kStep_s * twist_per_s) * point_m;
  EXPECT_LT(((moved_m - point_m) / kStep_s - velocity_of(point_m, twist_per_s)).norm(), 1e-5);
}

}  // namespace
}  // namespace hermite
