#include "server/capture/kinect_depth.h"

#include <gtest/gtest.h>

namespace hermite::client::kinect_depth_test {
namespace {

TEST(KinectDepth, IsInMillimetresAndGrowsWithTheRawValue) {
  EXPECT_NEAR(kinect_depth_mm(500), 557, 1);
  EXPECT_NEAR(kinect_depth_mm(759), 1000, 3);
  EXPECT_NEAR(kinect_depth_mm(1000), 3848, 1);
  for (std::uint16_t raw = 1; kinect_depth_mm(raw) > 0; ++raw)
    EXPECT_GT(kinect_depth_mm(raw), kinect_depth_mm(static_cast<std::uint16_t>(raw - 1)) - 1);
}

TEST(KinectDepth, WhatIsNoMeasurementIsZero) {
  for (const int raw : {1084, 2046, 2047, 2048, 65535})
    EXPECT_EQ(kinect_depth_mm(static_cast<std::uint16_t>(raw)), 0) << raw;
}

}  // namespace
}  // namespace hermite::client::kinect_depth_test
