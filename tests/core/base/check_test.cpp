#include "core/base/check.h"

#include <gtest/gtest.h>

namespace hermite {
namespace {

TEST(Check, AConditionThatHoldsCostsNoMessage) {
  int evaluated = 0;
  const auto message = [&] {
    ++evaluated;
    return std::string("never");
  };
  CHECK(1 + 1 == 2, message());
  EXPECT_EQ(evaluated, 0);
}

TEST(CheckDeathTest, SaysWhereWhatAndWhy) {
  const int slot_count = 3;
  EXPECT_DEATH(CHECK(slot_count > 5, "only " + std::to_string(slot_count)),
               "check_test.cpp:[0-9]+: CHECK\\(slot_count > 5\\) failed: only 3");
}

TEST(Check, IsOneStatementInsideIf) {
  if (false)
    CHECK(false, "not reached");
  else
    SUCCEED();
}

}  // namespace
}  // namespace hermite
