#include "core/disturb/key_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::disturb {
namespace {

using testing::HasSubstr;

struct Options {
  double speed = 1;
  std::int64_t count = 2;
};

Status apply(const std::string& text, Options& options) {
  return apply_key_values(
      text, {number_rule("speed", 0.5, 2, options.speed),
             whole_rule("count", 1, 10, [&](std::int64_t value) { options.count = value; })});
}

TEST(KeyValues, SetsWhatIsNamedAndLeavesTheRest) {
  Options options;
  EXPECT_TRUE(apply("", options).ok());
  EXPECT_TRUE(apply("speed=1.5", options).ok());
  EXPECT_EQ(options.speed, 1.5);
  EXPECT_EQ(options.count, 2);
  EXPECT_TRUE(apply("count=10,speed=2", options).ok());
  EXPECT_EQ(options.count, 10);
}

TEST(KeyValues, ErrorsNameTheKeyTheValueAndWhatIsAllowed) {
  Options options;
  EXPECT_THAT(apply("speed=3", options).error().message,
              HasSubstr("option speed is \"3\", allowed is a number from 0.5 to 2"));
  EXPECT_THAT(apply("count=0", options).error().message,
              HasSubstr("option count is \"0\", allowed is a whole number from 1 to 10"));
  EXPECT_THAT(apply("size=3", options).error().message,
              HasSubstr("there is no option \"size\" (there are: speed, count)"));
  EXPECT_THAT(apply("count=1,count=2", options).error().message,
              HasSubstr("\"count\" is given twice"));
}

TEST(KeyValues, TextThatIsNoListIsRefused) {
  Options options;
  for (const char* text :
       {"speed", ",", "speed=1,", "=1", "speed=", "speed=nan", "count=1.5", "speed =1"})
    EXPECT_EQ(apply(text, options).error().code, ErrorCode::kInvalidArgument) << text;
}

}  // namespace
}  // namespace hermite::disturb
