#include "core/evaluate/depth_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::evaluate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

DepthFindings of_a_room() {
  DepthFindings found;
  found.survey = {.valid_share = 0.8,
                  .nearest = 700,
                  .median = 1900,
                  .farthest = 3500,
                  .distinct_values = 400,
                  .common_divisor = 1};
  found.unit = {.units_per_metre = 1000, .reason = "as in rooms", .is_doubtful = false};
  return found;
}

TEST(DepthDoubts, ARoomHasNone) { EXPECT_THAT(depth_doubts(of_a_room()), IsEmpty()); }

TEST(DepthDoubts, UnitShareRangeAndRegistrationEachHaveTheirMessage) {
  DepthFindings found = of_a_room();
  found.unit.is_doubtful = true;
  EXPECT_THAT(depth_doubts(found), ElementsAre("depth unit: as in rooms"));
  found = of_a_room();
  found.survey.valid_share = 0.12;
  EXPECT_THAT(depth_doubts(found), ElementsAre("only 12 % of the pixels have depth"));
  found = of_a_room();
  found.survey.nearest = 100;
  EXPECT_THAT(depth_doubts(found), ElementsAre(HasSubstr("depth from 0.10 to 3.50 m")));
  found = of_a_room();
  found.survey.farthest = 65000;
  EXPECT_THAT(depth_doubts(found), ElementsAre(HasSubstr("to 65.00 m")));
  found = of_a_room();
  found.registration =
      RegistrationFit{.scale = 1.1, .dx_px = -8, .dy_px = 3, .gain = 2.5, .worst_px = 40};
  EXPECT_THAT(depth_doubts(found), ElementsAre(HasSubstr("moved by (-8, 3) pixels")));
}

TEST(DepthDoubts, WithoutDepthThereIsNoRangeToDoubt) {
  DepthFindings found;
  EXPECT_THAT(depth_doubts(found), ElementsAre(HasSubstr("only 0 %")));
}

}  // namespace
}  // namespace hermite::evaluate
