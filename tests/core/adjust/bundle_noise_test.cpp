#include "core/adjust/bundle_noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite {
namespace {

TEST(DepthDeviation, FollowsTheFormulaWhereItIsPositive) {
  EXPECT_NEAR(depth_deviation_m(1.0), 0.00289, 1e-9);  // 2.73 + 0.74 - 0.58 mm
  EXPECT_NEAR(depth_deviation_m(2.0), 0.01182, 1e-9);  // 10.92 + 1.48 - 0.58 mm
}

TEST(DepthDeviation, IsNeverBelowAMillimetre) {
  for (const double depth_m : {0.0, 0.3, 0.345, 0.5}) EXPECT_EQ(depth_deviation_m(depth_m), 0.001) << depth_m;
}

TEST(Chi2Bounds, AreTheNinetyFivePerCentQuantiles) {
  // The distribution function of an even number of degrees of freedom has a closed form.
  const double p2 = 1 - std::exp(-kPixelChi2 / 2), h = kPoseChi2 / 2, p6 = 1 - std::exp(-h) * (1 + h + h * h / 2);
  // Three degrees: erf(sqrt(x/2)) - sqrt(2x/pi) exp(-x/2).
  const double x = kPixelAndDepthChi2, p3 = std::erf(std::sqrt(x / 2)) - std::sqrt(2 * x / M_PI) * std::exp(-x / 2);
  for (const double p : {p2, p3, p6}) EXPECT_NEAR(p, 0.95, 1e-4);
}

}  // namespace
}  // namespace hermite
