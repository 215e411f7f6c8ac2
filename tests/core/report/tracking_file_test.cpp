#include "core/report/tracking_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::report {
namespace tracking_file_test {

using testing::HasSubstr;

TEST(TrackingFile, ComesBackAsItWasWritten) {
  pipeline::ReasonTable reasons;
  const std::uint16_t fast = reasons.number_of("too fast"),
                      dark = reasons.number_of("dark or blurred: the picture shows nothing");
  const std::vector<pipeline::AnchoredPose> poses{
      {0, 0, {}, track::TrackingStatus::kTracked, pipeline::kNoReason},
      {0.0333333333, 0, {}, track::TrackingStatus::kWeak, dark},
      {1.1, 0, {}, track::TrackingStatus::kLost, pipeline::kNoReason},
      {1305031102.175304, 1, {}, track::TrackingStatus::kLost, fast}};
  const std::string text = format_tracking(poses, reasons);
  EXPECT_EQ(text,
            "0.000000 tracked\n0.033333 weak dark or blurred: the picture shows nothing\n1.100000 "
            "lost\n1305031102.175304 lost too fast\n");
  const Result<TrackingFile> file = parse_tracking(text);
  ASSERT_TRUE(file.ok()) << file.error().message;
  ASSERT_EQ(file->frames.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(file->frames[i].timestamp_s, poses[i].timestamp_s, 1e-6);
    EXPECT_EQ(file->frames[i].status, poses[i].status);
    EXPECT_EQ(file->reasons.text_of(file->frames[i].reason), reasons.text_of(poses[i].reason));
  }
  EXPECT_TRUE(parse_tracking("")->frames.empty());
}

TEST(TrackingFile, FilesOfEarlierVersionsHaveNoReasons) {
  const Result<TrackingFile> file = parse_tracking("0.1 tracked\n0.2 lost\n0.3 weak");
  ASSERT_TRUE(file.ok()) << file.error().message;
  ASSERT_EQ(file->frames.size(), 3u);
  EXPECT_EQ(file->frames[1].status, track::TrackingStatus::kLost);
  EXPECT_EQ(file->reasons.size(), 0u);
}

TEST(TrackingFile, WhatIsWrongIsNamedByItsLine) {
  const std::string longest = "0.5 lost " + std::string(pipeline::kMaxReasonBytes, 'x');
  EXPECT_TRUE(parse_tracking(longest).ok());
  for (const std::string& line :
       {std::string(), std::string("0.5"), std::string("0.5 "), std::string("0.5 good"),
        std::string("tracked"), std::string("0.5  tracked"), std::string("0.5 lostx"),
        std::string("0.5 lost "), longest + "x", std::string("0.5 lost too\tfast"),
        std::string("0.5 lost \xff"), std::string("0.5 lost x\r")}) {
    const auto file = parse_tracking("0.1 tracked\n" + line + "\n");
    ASSERT_FALSE(file.ok()) << line;
    EXPECT_EQ(file.error().code, ErrorCode::kCorruptData);
    EXPECT_THAT(file.error().message, HasSubstr("line 2 "));
  }
}

}  // namespace tracking_file_test
}  // namespace hermite::report
