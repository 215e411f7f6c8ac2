#include "core/base/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

namespace hermite {
namespace {

Result<int> half_of(int value) {
  if (value % 2 != 0) return Error{ErrorCode::kInvalidArgument, "value is odd"};
  return value / 2;
}

TEST(Result, HoldsAValueOrAnError) {
  const Result<int> good = half_of(8);
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(*good, 4);
  const Result<int> bad = half_of(7);
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(bad.error().message, "value is odd");
}

TEST(Result, ValuesMayBeChangedAndMovedOut) {
  Result<std::string> text = std::string("scan");
  *text += "s";
  EXPECT_EQ(text->size(), 5u);
  Result<std::unique_ptr<int>> owner = std::make_unique<int>(3);
  const std::unique_ptr<int> taken = *std::move(owner);
  EXPECT_EQ(*taken, 3);
}

TEST(Result, StatusIsAResultWithoutAValue) {
  const Status done = Done{};
  EXPECT_TRUE(done.ok());
  const Status failed = Error{ErrorCode::kIo, "disk full"};
  EXPECT_EQ(failed.error().code, ErrorCode::kIo);
}

TEST(Error, ContextKeepsTheCodeAndGrowsOutwards) {
  const Error inner{ErrorCode::kCorruptData, "cut short"};
  const Error outer = in_context("frame 7", in_context("depth", inner));
  EXPECT_EQ(outer.code, ErrorCode::kCorruptData);
  EXPECT_EQ(outer.message, "frame 7: depth: cut short");
}

TEST(Error, EveryCodeHasItsOwnWord) {
  std::set<std::string> names;
  constexpr int kCodeCount = static_cast<int>(ErrorCode::kBusy) + 1;
  for (int code = 0; code < kCodeCount; ++code) names.insert(name_of(static_cast<ErrorCode>(code)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kCodeCount));
  EXPECT_FALSE(names.contains("unknown"));
  EXPECT_STREQ(name_of(ErrorCode::kCorruptData), "corrupt_data");
}

TEST(SetupError, CarriesTheErrorAndItsMessage) {
  try {
    throw SetupError({ErrorCode::kNotFound, "no such sequence"});
  } catch (const std::exception& error) {
    EXPECT_STREQ(error.what(), "no such sequence");
    EXPECT_EQ(dynamic_cast<const SetupError&>(error).error().code, ErrorCode::kNotFound);
  }
}

TEST(ResultDeathTest, TakingWhatIsNotThereIsOurOwnMistake) {
  EXPECT_DEATH(static_cast<void>(*half_of(3)), "value of a failed Result: value is odd");
  EXPECT_DEATH(static_cast<void>(half_of(4).error()), "error\\(\\) of a successful Result");
}

}  // namespace
}  // namespace hermite
