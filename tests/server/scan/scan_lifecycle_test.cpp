#include "server/scan/scan_lifecycle.h"

#include <gtest/gtest.h>

namespace hermite::server::scan_lifecycle_test {
namespace {

const Error kWhy{ErrorCode::kBusy, "somebody stopped it"};

ScanEnd end_in(wire::ScanPhase phase) {
  ScanEnd end;
  end.phase = phase;
  return end;
}

TEST(ScanLifecycle, EndsEarlyOnceAndForTheFirstReason) {
  ScanLifecycle scan(false);
  EXPECT_TRUE(scan.takes_frames());
  EXPECT_TRUE(scan.end_early(kWhy));
  EXPECT_FALSE(scan.end_early({ErrorCode::kIo, "another one"}, EndCause::kNoRoom));
  EXPECT_EQ(scan.why_ending().message, kWhy.message);
  EXPECT_FALSE(scan.lacked_room());
  EXPECT_TRUE(scan.is_ending());
  EXPECT_FALSE(scan.takes_frames());
  EXPECT_FALSE(scan.is_over()) << "its results are being made";
  EXPECT_EQ(scan.ended(end_in(wire::ScanPhase::kInterrupted)).phase, wire::ScanPhase::kInterrupted);
  EXPECT_TRUE(scan.is_over());
}

TEST(ScanLifecycle, WithAllItsFramesItDoesNotEndEarlyButMayBeDiscarded) {
  ScanLifecycle scan(false);
  scan.all_frames_came();
  EXPECT_FALSE(scan.takes_frames());
  EXPECT_FALSE(scan.is_ending());
  EXPECT_FALSE(scan.end_early(kWhy));
  EXPECT_TRUE(scan.discard());
  EXPECT_FALSE(scan.discard());
  const ScanEnd end = scan.ended(end_in(wire::ScanPhase::kRunning));
  EXPECT_TRUE(end.discarded);
  EXPECT_EQ(end.phase, wire::ScanPhase::kInterrupted);
  EXPECT_EQ(end.error.code, ErrorCode::kNotFound);
}

TEST(ScanLifecycle, HasAllFramesFromTheBeginningIfAnEarlierServerHad) {
  EXPECT_TRUE(ScanLifecycle(true).has_all_frames());
}

TEST(ScanLifecycle, LeftToTheNextServerItTakesNoFramesAndIsNotOver) {
  ScanLifecycle scan(false);
  scan.leave(kWhy);
  scan.ended(end_in(wire::ScanPhase::kRunning));
  EXPECT_TRUE(scan.is_ending());
  EXPECT_FALSE(scan.is_over());
}

TEST(ScanLifecycle, LacksRoomForFramesOrForResults) {
  ScanLifecycle for_frames(false);
  EXPECT_TRUE(for_frames.end_early(kWhy, EndCause::kNoRoom));
  EXPECT_TRUE(for_frames.lacked_room());
  ScanLifecycle for_results(false);
  ScanEnd end = end_in(wire::ScanPhase::kInterrupted);
  end.results_missing = true;
  for_results.ended(end);
  EXPECT_TRUE(for_results.lacked_room());
}

}  // namespace
}  // namespace hermite::server::scan_lifecycle_test
