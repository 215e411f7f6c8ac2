#include "server/access/rate_limit.h"

#include <gtest/gtest.h>

namespace hermite::server {
namespace {

TEST(RateLimit, AllowsABurstAndThenTheRate) {
  RateLimit limit(2, 3);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(limit.take("a", 1000), 0);
  EXPECT_EQ(limit.take("a", 1000), 500);
  EXPECT_EQ(limit.take("a", 1499), 1);
  EXPECT_EQ(limit.take("a", 1500), 0);
  EXPECT_GT(limit.take("a", 1500), 0);
  EXPECT_EQ(limit.take("a", 100'000), 0) << "and no more than the burst is saved up:";
  EXPECT_EQ(limit.take("a", 100'000), 0);
  EXPECT_EQ(limit.take("a", 100'000), 0);
  EXPECT_GT(limit.take("a", 100'000), 0);
}

TEST(RateLimit, AddressesDoNotTakeFromEachOther) {
  RateLimit limit(1, 1);
  EXPECT_EQ(limit.take("a", 0), 0);
  EXPECT_GT(limit.take("a", 0), 0);
  EXPECT_EQ(limit.take("b", 0), 0);
}

TEST(RateLimit, SurvivesAClockThatIsSetBack) {
  RateLimit limit(1, 1);
  EXPECT_EQ(limit.take("a", 1'000'000), 0);
  EXPECT_EQ(limit.take("a", 0), 1000);
  EXPECT_EQ(limit.take("a", 1000), 0);
}

TEST(RateLimit, RemembersABoundedNumberOfAddresses) {
  RateLimit limit(1, 2);
  constexpr int kAddresses = 3 * static_cast<int>(kMaxLimitedAddresses);
  for (int i = 0; i < kAddresses; ++i) limit.take(std::to_string(i), 10'000);
  EXPECT_LE(limit.remembered_count(), kMaxLimitedAddresses + 1);
  EXPECT_GT(limit.take("one more", 10'000), 0)
      << "those that did not fit share an allowance, which is used up";
  EXPECT_EQ(limit.take("0", 10'000), 0) << "who came before has its own";
  EXPECT_EQ(limit.take("one more", 20'000), 0);
  EXPECT_LE(limit.remembered_count(), 3u) << "the idle are forgotten";
}

TEST(CountLimit, CountsInAllAndForEachAddress) {
  CountLimit limit(3, 2);
  EXPECT_TRUE(limit.enter("a"));
  EXPECT_TRUE(limit.enter("a"));
  EXPECT_FALSE(limit.enter("a"));
  EXPECT_TRUE(limit.enter("b"));
  EXPECT_FALSE(limit.enter("c"));
  limit.leave("a");
  EXPECT_TRUE(limit.enter("c"));
  EXPECT_EQ(limit.count(), 3);
}

TEST(CountLimit, TheEmptyAddressIsHeldToTheLimitInAllOnly) {
  CountLimit limit(3, 1);
  EXPECT_TRUE(limit.enter(""));
  EXPECT_TRUE(limit.enter(""));
  EXPECT_TRUE(limit.enter("a"));
  EXPECT_FALSE(limit.enter(""));
  limit.leave("");
  EXPECT_TRUE(limit.enter(""));
}

TEST(CountLimitDeathTest, WhoLeavesHasEntered) {
  CountLimit limit(1, 1);
  EXPECT_DEATH(limit.leave("a"), "without having entered");
}

}  // namespace
}  // namespace hermite::server
