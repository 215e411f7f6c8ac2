#include "core/report/tracking_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite {
namespace tracking_file_test {

TEST(TrackingFile, ComesBackAsItWasWritten) {
  const std::vector<AnchoredPose> poses{{0, 0, {}, TrackingStatus::kTracked},
                                        {0.0333333333, 0, {}, TrackingStatus::kWeak},
                                        {1305031102.175304, 1, {}, TrackingStatus::kLost}};
  const std::string text = format_tracking(poses);
  EXPECT_EQ(text, "0.000000 tracked\n0.033333 weak\n1305031102.175304 lost\n");
  const Result<std::vector<TimedStatus>> statuses = parse_tracking(text);
  ASSERT_TRUE(statuses.ok()) << statuses.error().message;
  ASSERT_EQ(statuses->size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR((*statuses)[i].timestamp_s, poses[i].timestamp_s, 1e-6);
    EXPECT_EQ((*statuses)[i].status, poses[i].status);
  }
  EXPECT_TRUE(parse_tracking("")->empty());
}

TEST(TrackingFile, WhatIsWrongIsNamedByItsLine) {
  for (const char* line : {"", "0.5", "0.5 ", "0.5 good", "tracked", "0.5  tracked", "0.5 tracked lost"}) {
    const auto statuses = parse_tracking("0.1 tracked\n" + std::string(line) + "\n");
    ASSERT_FALSE(statuses.ok()) << line;
    EXPECT_THAT(statuses.error().message, testing::HasSubstr("line 2 "));
  }
}

}  // namespace tracking_file_test
}  // namespace hermite
