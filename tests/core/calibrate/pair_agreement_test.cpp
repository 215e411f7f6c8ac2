#include "core/calibrate/pair_agreement.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::calibrate {
namespace {

TEST(PairAgreement, TheGainIsTheMeanRelativeDecreaseOfSquares) {
  // The last two have no square before or after.
  const PairGain gain = gain_of({4, 10, 0, 8}, {3, 5, 1, 0});
  EXPECT_DOUBLE_EQ(gain.mean, 0.375);
  EXPECT_DOUBLE_EQ(gain.standard_error, 0.125);
  EXPECT_EQ(gain.pair_count, 2u);
}

TEST(PairAgreement, OnePairHasNoStandardErrorAndNoGain) {
  EXPECT_EQ(gain_of({4}, {1}).pair_count, 0u);
  EXPECT_EQ(gain_of({}, {}).mean, 0);
}

TEST(PairAgreement, SquaresAreRelativeToDepthAndZeroWithoutPoints) {
  const std::vector<double> squares =
      squares_of(std::vector<PairAgreement>{{0.001, 0.004, 0.0005, 0.002, 100}, {}});
  ASSERT_EQ(squares.size(), 2u);
  EXPECT_DOUBLE_EQ(squares[0], std::pow(0.002, 2));
  EXPECT_EQ(squares[1], 0);
  EXPECT_EQ(squares_of(std::vector<CornerReprojection>{{1.5, 10}}), std::vector<double>{2.25});
}

}  // namespace
}  // namespace hermite::calibrate
