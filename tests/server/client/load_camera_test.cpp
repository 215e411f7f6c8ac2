// A camera without a server; load_test.cpp has it with one.
#include "server/client/load_camera.h"
#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::client::load_camera_test {
namespace {

TEST(LoadClock, EndsByTime) {
  LoadClock running(std::chrono::hours(1), [] { return 0; });
  EXPECT_EQ(running.wish(), 0);
  LoadClock over(std::chrono::seconds(0), [] { return 0; });
  EXPECT_EQ(over.wish(), 1);
  EXPECT_EQ(over.wish(), 1) << "the cameras have some time to finish";
  EXPECT_FALSE(over.interrupted());
}

TEST(LoadClock, EndsByInterrupt) {
  int interrupts = 0;
  LoadClock clock(std::chrono::hours(1), [&interrupts] { return interrupts; });
  interrupts = 1;
  EXPECT_EQ(clock.wish(), 1);
  EXPECT_TRUE(clock.interrupted());
  interrupts = 2;
  EXPECT_EQ(clock.wish(), 2);
}

TEST(LoadCamera, TriesAgainUntilTheTimeIsOver) {
  const auto sequence = *source::open_sequence("synthetic:frames=3,width=160,height=120");
  LoadFrames frames(*sequence, std::size_t{1} << 30);
  LoadScans scans;
  LoadClock clock(std::chrono::milliseconds(1500), [] { return 0; });
  LoadCounters counters;
  StreamRequest request;
  request.server = {"127.0.0.1", 1, "token"};
  request.title = "load test";
  request.pacing = {.rate_hz = 10, .newest_wins = true};
  const CameraLoad load = run_load_camera({request, frames, scans, clock, counters}, 1,
                                          std::chrono::duration<double>(0));
  EXPECT_GE(load.refused, 2u);
  EXPECT_EQ(load.scans_begun, 0u);
  ASSERT_EQ(load.refusals.size(), 1u);
  EXPECT_THAT(load.refusals.begin()->first, testing::HasSubstr("cannot connect to 127.0.0.1:1"));
  EXPECT_TRUE(scans.all().empty());
  EXPECT_EQ(counters.scanning + counters.waiting, 0);
}

}  // namespace
}  // namespace hermite::client::load_camera_test
