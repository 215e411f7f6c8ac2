#include "server/scan/arrivals.h"

#include <gtest/gtest.h>

namespace hermite::server {
namespace {

using namespace std::chrono_literals;
using Clock = Arrivals::Clock;

const Clock::time_point kStart = Clock::time_point() + 1h;

TEST(Arrivals, RemembersTheNewestFrames) {
  Arrivals arrivals;
  EXPECT_FALSE(arrivals.of(0));
  for (std::uint64_t i = 0; i <= Arrivals::kMostFrames; ++i)
    arrivals.frame_done(i, kStart + i * 1ms, kStart + i * 1ms + 80ms);
  EXPECT_FALSE(arrivals.of(0)) << "memory is bounded";
  EXPECT_EQ(arrivals.of(1), kStart + 1ms);
  EXPECT_EQ(arrivals.of(Arrivals::kMostFrames), kStart + Arrivals::kMostFrames * 1ms);
  EXPECT_FALSE(arrivals.of(Arrivals::kMostFrames + 1));
}

TEST(Arrivals, PointsAreAsOldAsTheOldestFrameThatTheyShowFirst) {
  Arrivals arrivals;
  EXPECT_FALSE(arrivals.points_delay());
  arrivals.frame_done(0, kStart, kStart + 100ms);
  arrivals.frame_done(1, kStart + 50ms, kStart + 200ms);
  arrivals.frame_done(2, kStart + 100ms, kStart + 300ms);
  arrivals.points_encoded(kStart + 250ms, kStart + 400ms);  // without frame 2
  EXPECT_EQ(arrivals.points_delay(), 400ms);
  arrivals.points_encoded(kStart + 350ms, kStart + 450ms);
  EXPECT_EQ(arrivals.points_delay(), 350ms) << "of frame 2 only";
  arrivals.points_encoded(kStart + 500ms, kStart + 900ms);
  EXPECT_EQ(arrivals.points_delay(), 350ms) << "no new frame is in these";
}

TEST(Arrivals, TheSurfaceTellsItsOwnDelay) {
  Arrivals arrivals;
  EXPECT_FALSE(arrivals.surface_delay());
  arrivals.surface_made(640ms);
  EXPECT_EQ(arrivals.surface_delay(), 640ms);
}

}  // namespace
}  // namespace hermite::server
