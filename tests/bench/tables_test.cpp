#include "tests/bench/program/tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bench/made_up.h"

namespace hermite::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<PassCost> kCosts{{"map/merge", 10, 2000, 0, 0}};

Roofline roofline() {
  Roofline roofline;
  roofline.memory_gb_per_s = 1;
  roofline.gflop_per_s = 1;
  return roofline;
}

TEST(Tables, EveryStageHasANumberForEveryFrame) {
  const std::vector<Series> stages = stage_times_ms(made_up_measurement());
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_EQ(stages[0].name, "track");
  EXPECT_THAT(stages[0].values, ElementsAre(6, 3));
  EXPECT_EQ(stages[1].name, "fuse");
  EXPECT_THAT(stages[1].values, ElementsAre(2.5, 0)) << "a lost frame is not fused";
}

TEST(Tables, PassesAreSummedByFrameTheDearestFirst) {
  const std::vector<PassSeries> passes = pass_times(made_up_measurement(), kCosts, roofline());
  ASSERT_EQ(passes.size(), 2u);
  EXPECT_EQ(passes[0].name, "map/merge");
  EXPECT_THAT(passes[0].gpu_ms, ElementsAre(3, 0));
  EXPECT_THAT(passes[0].bound_ms, ElementsAre(testing::DoubleNear(0.2, 1e-12), 0))
      << "100 invocations of 2000 flops at 1 GFLOP/s";
  EXPECT_EQ(passes[1].name, "track/odometry");
  EXPECT_THAT(passes[1].dispatches, ElementsAre(2, 1));
  EXPECT_THAT(passes[1].gpu_ms, ElementsAre(2, 0.5));
}

TEST(Tables, SayWhatWasMeasured) {
  const std::string text = format_tables(made_up_measurement(), kCosts, roofline());
  EXPECT_THAT(text, HasSubstr("| frame, wall clock | 4.00 | 10.00 | 10.00 |\n"));
  EXPECT_THAT(text, HasSubstr("| track | 3.00 | 6.00 | 6.00 |\n"));
  EXPECT_THAT(text, HasSubstr("| GPU passes together | 0.50 | 5.00 | 5.00 |\n"));
  EXPECT_THAT(text,
              HasSubstr("| map/merge | 0 | 0.000 | 3.000 | 54.5 | 0.0000 | arithmetic | 15.0 |\n"));
  EXPECT_THAT(text, HasSubstr("| track/odometry | 1 | 0.500 | 2.000 | 45.5 | – | – | – |\n"));
  EXPECT_THAT(text, HasSubstr("| frame | 1.50 |\n| map | 0.08 |\n| all | 1.58 |\n"));
  EXPECT_THAT(text, HasSubstr("| alive | 1000 | 80.0 |\n| slots in use | 2000 | 40.0 |\n| slots "
                              "there is memory for | 4000 | 20.0 |\n"));
}

TEST(Tables, OfNothingAreEmptyNotBroken) {
  const std::string text = format_tables({}, kCosts, roofline());
  EXPECT_THAT(text, HasSubstr("| frame, wall clock | 0.00 | 0.00 | 0.00 |"));
  EXPECT_THAT(text, HasSubstr("| alive | 0 | 0.0 |"));
}

}  // namespace
}  // namespace hermite::bench
