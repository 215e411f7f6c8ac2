#include "server/client/flow_control.h"

#include <gtest/gtest.h>

#include <vector>

namespace hermite::client {
namespace {

using std::chrono::milliseconds;

EncodedFrame frame(std::int64_t index) {
  EncodedFrame made;
  made.index = index;
  return made;
}

// Time is a number the test chooses.
SteadyTime at_ms(int ms) { return SteadyTime(milliseconds(100000 + ms)); }

TEST(CreditWindow, LetsOutAsManyFramesAsWereGrantedInAll) {
  CreditWindow credit(2);
  for (int k = 0; k < 2; ++k) {
    ASSERT_TRUE(credit.available());
    credit.take();
  }
  EXPECT_FALSE(credit.available());
  credit.grant_in_all(3);
  ASSERT_TRUE(credit.available());
  credit.take();
  EXPECT_FALSE(credit.available());
  EXPECT_EQ(credit.sent(), 3u);
}

TEST(CreditWindow, ANewConnectionMayStartWithLess) {
  CreditWindow credit(4);
  for (int k = 0; k < 4; ++k) credit.take();
  credit = CreditWindow(3, 2);
  ASSERT_TRUE(credit.available());
  credit.take();
  EXPECT_FALSE(credit.available());
  EXPECT_EQ(credit.sent(), 3u);
}

TEST(CreditWindow, ARepeatedOrLateGrantChangesNothing) {
  CreditWindow credit(4);
  credit.grant_in_all(2);
  for (int k = 0; k < 4; ++k) credit.take();
  credit.grant_in_all(4);
  credit.grant_in_all(0);
  EXPECT_FALSE(credit.available());
}

TEST(CreditWindow, WithoutAGrantNothingLeaves) { EXPECT_FALSE(CreditWindow().available()); }

TEST(CreditWindowDeathTest, AFrameWithoutCreditIsOurMistake) {
  EXPECT_DEATH(CreditWindow(0).take(), "without credit");
}

TEST(FrameGate, BatchSendsEveryFrameInOrderAndWaitsForCredit) {
  FrameGate gate({});
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(gate.wants(at_ms(k)));
    gate.offer(frame(k), at_ms(k));
    EXPECT_FALSE(gate.wants(at_ms(1000000)));
    EXPECT_FALSE(gate.take(at_ms(1000000), false));
    const auto taken = gate.take(at_ms(k), true);
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->index, k);
    EXPECT_TRUE(gate.empty());
  }
  EXPECT_EQ(gate.dropped_count(), 0u);
}

TEST(FrameGate, ARateHoldsFramesBackUntilTheyAreDue) {
  FrameGate gate({.rate_hz = 10, .newest_wins = false});
  gate.offer(frame(0), at_ms(0));
  EXPECT_TRUE(gate.take(at_ms(0), true));
  gate.offer(frame(1), at_ms(5));
  EXPECT_FALSE(gate.take(at_ms(99), true));
  EXPECT_EQ(gate.next_event(at_ms(5)), at_ms(100));
  EXPECT_TRUE(gate.take(at_ms(100), true));
  gate.offer(frame(2), at_ms(100));
  // The clock of the recording does not shift when one frame was late.
  EXPECT_TRUE(gate.take(at_ms(250), true));
  gate.offer(frame(3), at_ms(250));
  EXPECT_EQ(gate.next_event(at_ms(250)), at_ms(300));
}

TEST(FrameGate, BatchWithARateNeverDrops) {
  FrameGate gate({.rate_hz = 10, .newest_wins = false});
  gate.offer(frame(0), at_ms(0));
  EXPECT_FALSE(gate.wants(at_ms(5000)));
  EXPECT_EQ(gate.next_event(at_ms(5000)), std::nullopt);
  EXPECT_EQ(gate.take(at_ms(5000), true)->index, 0);
  EXPECT_EQ(gate.dropped_count(), 0u);
}

TEST(FrameGate, LiveReplacesTheWaitingFrameByTheNewestAndCounts) {
  FrameGate gate({.rate_hz = 10, .newest_wins = true});
  gate.offer(frame(0), at_ms(0));
  EXPECT_FALSE(gate.take(at_ms(0), false));
  EXPECT_FALSE(gate.wants(at_ms(99)));
  EXPECT_EQ(gate.next_event(at_ms(0)), at_ms(100));
  for (int k = 1; k <= 3; ++k) {
    ASSERT_TRUE(gate.wants(at_ms(100 * k)));
    gate.offer(frame(k), at_ms(100 * k));
    EXPECT_FALSE(gate.wants(at_ms(100 * k)));
  }
  const auto taken = gate.take(at_ms(310), true);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->index, 3);
  EXPECT_EQ(gate.dropped_count(), 3u);
}

TEST(FrameGate, AfterAPauseNoFrameIsOverdue) {
  FrameGate gate({.rate_hz = 10, .newest_wins = true});
  gate.offer(frame(0), at_ms(0));
  EXPECT_EQ(gate.take(at_ms(0), true)->index, 0);
  gate.go_on(at_ms(60'000));
  for (int k = 1; k <= 3; ++k) {
    gate.offer(frame(k), at_ms(60'000 + 100 * (k - 1)));
    EXPECT_FALSE(gate.wants(at_ms(60'050 + 100 * (k - 1)))) << "the clock stood still";
    EXPECT_EQ(gate.take(at_ms(60'050 + 100 * (k - 1)), true)->index, k);
  }
  EXPECT_EQ(gate.dropped_count(), 0u);
}

TEST(FrameGate, AMomentsPauseChangesNothing) {
  FrameGate gate({.rate_hz = 10, .newest_wins = false});
  gate.offer(frame(0), at_ms(0));
  EXPECT_EQ(gate.take(at_ms(0), true)->index, 0);
  gate.go_on(at_ms(30));
  gate.offer(frame(1), at_ms(40));
  EXPECT_FALSE(gate.take(at_ms(99), true));
  EXPECT_EQ(gate.take(at_ms(100), true)->index, 1);
}

TEST(FrameGate, LiveWithEnoughCreditDropsNothing) {
  FrameGate gate({.rate_hz = 10, .newest_wins = true});
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(gate.wants(at_ms(100 * k)));
    gate.offer(frame(k), at_ms(100 * k));
    EXPECT_EQ(gate.take(at_ms(100 * k), true)->index, k);
  }
  EXPECT_EQ(gate.dropped_count(), 0u);
}

TEST(FrameGate, LiveLeavesOutFramesAsItIsToldWhichIsNoDrop) {
  FrameGate gate({.rate_hz = 10, .newest_wins = true});
  gate.keep(2, 3);
  std::vector<std::int64_t> taken;
  for (int ms = 0; ms < 1000; ms += 10) {
    while (gate.wants(at_ms(ms)))
      gate.offer(frame(static_cast<std::int64_t>(gate.due_count() + gate.left_out_count())),
                 at_ms(ms));
    if (const auto next = gate.take(at_ms(ms), true)) {
      EXPECT_EQ(ms, 100 * next->index) << "a frame that is left out does not shift the others";
      taken.push_back(next->index);
    }
  }
  EXPECT_EQ(taken, (std::vector<std::int64_t>{0, 1, 3, 4, 6, 7, 9}));
  EXPECT_EQ(gate.dropped_count(), 0u);
  EXPECT_EQ(gate.left_out_count(), 3u);
}

TEST(FrameGate, AFrameThatIsLeftOutReplacesNoneThatWaits) {
  FrameGate gate({.rate_hz = 10, .newest_wins = true});
  gate.keep(1, 2);
  gate.offer(frame(0), at_ms(0));
  gate.offer(frame(1), at_ms(100));
  EXPECT_EQ(gate.take(at_ms(110), true)->index, 0);
  EXPECT_EQ(gate.dropped_count(), 0u);
  EXPECT_EQ(gate.due_count(), 1u);
}

TEST(FrameGate, ACameraWithItsOwnClockSendsEachFrameWhenItIsThereAndDropsForANewerOne) {
  FrameGate gate({.rate_hz = std::nullopt, .newest_wins = true});
  gate.offer(frame(0), at_ms(0));
  EXPECT_EQ(gate.take(at_ms(0), true)->index, 0);
  gate.offer(frame(1), at_ms(33));
  EXPECT_FALSE(gate.take(at_ms(33), false));
  ASSERT_TRUE(gate.wants(at_ms(34)));
  gate.offer(frame(2), at_ms(34));
  EXPECT_EQ(gate.take(at_ms(34), true)->index, 2);
  EXPECT_EQ(gate.dropped_count(), 1u);
  EXPECT_EQ(gate.next_event(at_ms(34)), std::nullopt);
}

TEST(FrameGateDeathTest, BatchLeavesNothingOut) {
  EXPECT_DEATH(FrameGate({}).keep(1, 2), "live camera");
}

TEST(FrameGate, LiveFramesThatAreEarlyWaitForTheirTime) {
  FrameGate gate({.rate_hz = 10, .newest_wins = true});
  gate.offer(frame(0), at_ms(0));
  EXPECT_TRUE(gate.take(at_ms(0), true));
  gate.offer(frame(1), at_ms(1));
  EXPECT_FALSE(gate.wants(at_ms(50)));
  EXPECT_FALSE(gate.take(at_ms(50), true));
  EXPECT_EQ(gate.next_event(at_ms(50)), at_ms(100));
}

TEST(FrameGate, AnEmptyGateWaitsForNoClock) {
  EXPECT_EQ(FrameGate({.rate_hz = 10, .newest_wins = true}).next_event(at_ms(0)), std::nullopt);
  EXPECT_EQ(FrameGate({}).next_event(at_ms(0)), std::nullopt);
}

}  // namespace
}  // namespace hermite::client
