#include "core/adjust/bundle_noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::adjust {
namespace {

TEST(DepthDeviation, FollowsTheFormulaWhereItIsPositive) {
  EXPECT_NEAR(depth_deviation_m(1.0), 0.00289, 1e-9);  // 2.73 + 0.74 - 0.58 mm
  EXPECT_NEAR(depth_deviation_m(2.0), 0.01182, 1e-9);  // 10.92 + 1.48 - 0.58 mm
}

TEST(DepthDeviation, IsNeverBelowAMillimetre) {
  for (const double depth_m : {0.0, 0.3, 0.345, 0.5})
    EXPECT_EQ(depth_deviation_m(depth_m), 0.001) << depth_m;
}

TEST(WeightOfObservation, IsOneForASingleOneAndNothingToACameraThatTurnsNoPixel) {
  EXPECT_EQ(weight_of_observation(0, 525), 1);
  EXPECT_EQ(weight_of_observation(1, 525), 1);
  EXPECT_NEAR(weight_of_observation(300, 1e-6), 1, 1e-12);
}

TEST(WeightOfObservation, SumsToTheInverseOfTheCorrelationAtMost) {
  const double s_px = 525 * kTracked_rad, correlation = s_px * s_px / (1 + s_px * s_px);  // 0.18
  EXPECT_NEAR(weight_of_observation(2, 525), 1 / (1 + correlation), 1e-12);
  double before = 0;
  for (const std::size_t count : {1u, 10u, 100u, 1000u, 100'000u}) {
    const double total = static_cast<double>(count) * weight_of_observation(count, 525);
    EXPECT_GT(total, before);
    before = total;
  }
  EXPECT_NEAR(before, 1 / correlation, 1e-3);
}

TEST(Chi2Bounds, AreTheNinetyFivePerCentQuantiles) {
  // The distribution function of an even number of degrees of freedom has a closed form.
  const double p2 = 1 - std::exp(-kPixelChi2 / 2), h = kPoseChi2 / 2,
               p6 = 1 - std::exp(-h) * (1 + h + h * h / 2);
  // Three degrees: erf(sqrt(x/2)) - sqrt(2x/pi) exp(-x/2).
  const double x = kPixelAndDepthChi2,
               p3 = std::erf(std::sqrt(x / 2)) - std::sqrt(2 * x / M_PI) * std::exp(-x / 2);
  for (const double p : {p2, p3, p6}) EXPECT_NEAR(p, 0.95, 1e-4);
}

}  // namespace
}  // namespace hermite::adjust
