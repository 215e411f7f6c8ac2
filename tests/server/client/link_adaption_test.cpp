#include "server/client/link_adaption.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace hermite::client {
namespace {

constexpr LinkCounts kCalm{30, 0}, kFew{30, 3}, kMany{30, 4};

LinkState after(LinkState state, const LinkCounts& counts, int seconds) {
  for (int s = 0; s < seconds; ++s) state = after_a_second(state, counts);
  return state;
}

TEST(LinkLevels, GetSmallerStepByStepAndKeepAThirdOfTheFrames) {
  double rate = 1;
  int quality = 100;
  for (int level = 0; level < kLinkLevels; ++level) {
    const LinkLevel now = link_level(level);
    const double now_rate = static_cast<double>(now.kept_frames) / now.of_frames;
    const int now_quality = now.jpeg_quality.value_or(100);
    EXPECT_TRUE(level == 0 || now_rate < rate || now_quality < quality) << level;
    EXPECT_LE(now_rate, rate);
    EXPECT_LE(now_quality, quality);
    rate = now_rate;
    quality = now_quality;
  }
  EXPECT_DOUBLE_EQ(rate, 1.0 / 3);
  EXPECT_EQ(quality, 70);
}

TEST(LinkLevels, AreSaidAsText) {
  EXPECT_EQ(as_text(link_level(0)), "");
  EXPECT_EQ(as_text(link_level(2)), "colour q80");
  EXPECT_EQ(as_text(link_level(4)), "colour q70, 2 of 3 frames");
}

TEST(LinkAdaption, AGoodLinkIsLeftAlone) { EXPECT_EQ(after({}, kCalm, 1000).level, 0); }

TEST(LinkAdaption, ABadLinkCostsALevelASecondDownToTheLast) {
  for (int s = 1; s < kLinkLevels; ++s) EXPECT_EQ(after({}, kMany, s).level, s);
  EXPECT_EQ(after({}, kMany, 100).level, kLinkLevels - 1);
}

TEST(LinkAdaption, ATenthLostChangesNothingEitherWay) {
  const LinkState state = after({}, kMany, 2);
  EXPECT_EQ(after(state, kFew, 1000).level, 2);
}

TEST(LinkAdaption, APausedCameraSaysNothing) {
  const LinkState state = after({}, kMany, 2);
  EXPECT_EQ(after(state, {0, 0}, 1000).level, 2);
}

TEST(LinkAdaption, ARecoveredLinkGetsEverythingBack) {
  LinkState state = after({}, kMany, 100);
  EXPECT_EQ(after(state, kCalm, 4).level, kLinkLevels - 1) << "not before the patience is over";
  EXPECT_EQ(after(state, kCalm, 5).level, kLinkLevels - 2);
  EXPECT_EQ(after(state, kCalm, 5 * (kLinkLevels - 1)).level, 0);
}

// A link that carries level 3 and nothing better.
TEST(LinkAdaption, ALinkBetweenTwoLevelsIsTriedLessAndLessOften) {
  LinkState state;
  std::vector<int> tried_at_s;
  for (int s = 0; s < 600; ++s) {
    const int before = state.level;
    state = after_a_second(state, state.level < 3 ? kMany : kCalm);
    if (state.level < before) tried_at_s.push_back(s);
    if (s >= 3) {
      EXPECT_GE(state.level, 2);
      EXPECT_LE(state.level, 3);
    }
  }
  EXPECT_LE(tried_at_s.size(), 14u) << "5, 10, 20, 40, then 60 seconds apart";
  EXPECT_GE(tried_at_s.back() - tried_at_s[tried_at_s.size() - 2], 60);
}

TEST(LinkAdaption, ALevelThatHoldsSetsThePatienceBack) {
  LinkState state = after({}, kMany, 3);
  for (int failed = 0; failed < 3; ++failed) {
    while (state.level == 3) state = after_a_second(state, kCalm);
    state = after_a_second(state, kMany);
  }
  EXPECT_EQ(state.patience_s, 40);
  while (state.level == 3) state = after_a_second(state, kCalm);
  EXPECT_EQ(after(state, kCalm, 5).patience_s, 5);
}

}  // namespace
}  // namespace hermite::client
