#include "server/disk/retention_clock.h"

#include <gtest/gtest.h>

#include <fstream>

#include "server/store/unix_time.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

class RetentionClockTest : public testing::Test {
 protected:
  RetentionClock start(std::int64_t clock_ms) { return {path_, clock_ms, now_}; }
  const test::TemporaryFolder folder_;
  const std::string path_ = folder_ / "time";
  const RetentionClock::Steady::time_point now_ = RetentionClock::Steady::now();
  static constexpr std::int64_t kToday_ms = 20'000 * kDay_ms;
};

TEST_F(RetentionClockTest, IsTheClockWhileThatIsRight) {
  RetentionClock clock = start(kToday_ms);
  EXPECT_EQ(clock.now_ms(), kToday_ms);
  clock.tick(kToday_ms + 5000, now_ + std::chrono::seconds(5));
  EXPECT_EQ(clock.now_ms(), kToday_ms + 5000);
}

TEST_F(RetentionClockTest, AClockThatIsFarAheadAtAStartRemovesNothingAtOnce) {
  start(kToday_ms);
  RetentionClock clock = start(kToday_ms + 400 * kDay_ms);
  EXPECT_EQ(clock.now_ms(), kToday_ms + kDay_ms);
  clock.tick(kToday_ms + 400 * kDay_ms + 3'600'000, now_ + std::chrono::hours(1));
  EXPECT_EQ(clock.now_ms(), kToday_ms + kDay_ms + 2 * 3'600'000);
  EXPECT_EQ(start(kToday_ms).now_ms(), kToday_ms) << "and is never ahead of one that was put right";
}

TEST_F(RetentionClockTest, AClockThatJumpsWhileTheServerRunsDoesNotEither) {
  RetentionClock clock = start(kToday_ms);
  clock.tick(kToday_ms + 400 * kDay_ms, now_ + std::chrono::seconds(10));
  EXPECT_EQ(clock.now_ms(), kToday_ms + 20'000);
}

TEST_F(RetentionClockTest, AFileThatSaysNothingIsNoObstacle) {
  std::ofstream(path_) << "garbage";
  EXPECT_EQ(start(kToday_ms).now_ms(), kToday_ms);
}

}  // namespace
}  // namespace hermite::server
