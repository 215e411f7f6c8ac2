#include "server/capture/device_clock.h"

#include <gtest/gtest.h>

namespace hermite::client::device_clock_test {
namespace {

constexpr double kTicksPerSecond = 60e6;

TEST(DeviceClock, CountsFromTheFirstStamp) {
  DeviceClock clock(kTicksPerSecond);
  EXPECT_EQ(clock.seconds_of(123'456, 50), 0);
  EXPECT_DOUBLE_EQ(clock.seconds_of(123'456 + 2'000'000, 50.5), 1.0 / 30);
  EXPECT_DOUBLE_EQ(clock.seconds_of(123'456 + 60'000'000, 51), 1)
      << "the host's clock does not matter";
}

TEST(DeviceClock, GoesOnWhenTheCounterIsFull) {
  DeviceClock clock(kTicksPerSecond);
  clock.seconds_of(4'294'000'000, 0);
  EXPECT_DOUBLE_EQ(clock.seconds_of(4'294'000'000u + 2'000'000u, 0.03), 1.0 / 30);
}

TEST(DeviceClock, StepsBackALittleForTheOtherStream) {
  DeviceClock clock(kTicksPerSecond);
  clock.seconds_of(60'000'000, 0);
  EXPECT_NEAR(clock.seconds_of(60'600'000, 0), 0.010, 1e-9);
  EXPECT_NEAR(clock.seconds_of(60'300'000, 0), 0.005, 1e-9);
}

TEST(DeviceClock, AJumpIsWhatWentByHere) {
  DeviceClock clock(kTicksPerSecond);
  clock.seconds_of(3'000'000'000, 10);
  EXPECT_NEAR(clock.seconds_of(1'000'000, 10.25), 0.25, 1e-9) << "the camera was reset";
  EXPECT_NEAR(clock.seconds_of(3'000'000, 99), 0.25 + 1.0 / 30, 1e-9);
  EXPECT_NEAR(clock.seconds_of(1'203'000'000, 99.5), 0.75 + 1.0 / 30, 1e-9)
      << "20 s of ticks in half a second";
  EXPECT_NEAR(clock.seconds_of(3'000'000'000, 90), 0.75 + 1.0 / 30, 1e-9)
      << "a host's clock that was set back adds nothing";
}

}  // namespace
}  // namespace hermite::client::device_clock_test
