#include "server/capture/scan_display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::client::scan_display_test {
namespace {

using testing::HasSubstr;
using testing::Not;

ScanProgress under_way() {
  ScanProgress progress;
  progress.capture = {
      .frame_count = 1260, .first_s = 100, .newest_s = 142.3, .rate_hz = 29.94, .coverage = 0.81};
  progress.stream.scan_id = "4f";
  progress.stream.elapsed_s = 42;
  progress.stream.sent_bytes = 96'075'000;
  progress.stream.round_trip_ms = 12.4;
  progress.stream.last_result = wire::FrameResult{};
  progress.stream.last_result->status = wire::TrackingStatus::kTracked;
  progress.stream.last_result->timestamp_s = 142;
  return progress;
}

TEST(ScanDisplay, SaysWhatMattersWhileWalking) {
  ScanProgress told = under_way();
  told.stream.last_result->uncertainty = wire::PoseUncertainty{0.02, 0};
  EXPECT_THAT(format_scan_progress(told), testing::HasSubstr("  tracked +-4 cm  "));
  EXPECT_EQ(format_scan_progress(under_way()),
            "0:42  29.9 fps  81 % depth  tracked  0.3 s behind  18.3 Mbit/s  round trip 12 ms");
}

TEST(ScanDisplay, ALostCameraIsSentBackByTheClockOfTheScan) {
  ScanProgress progress = under_way();
  progress.stream.last_result->status = wire::TrackingStatus::kLost;
  progress.stream.last_result->reason = "too fast";
  EXPECT_THAT(format_scan_progress(progress),
              AllOf(HasSubstr("LOST: too fast"), Not(HasSubstr("go back"))));
  progress.stream.last_result->last_tracked = wire::TrackedFrame{1000, 139.2};
  EXPECT_THAT(format_scan_progress(progress),
              HasSubstr("LOST: too fast - go back to what was seen at 0:39"));
  progress.stream.last_result->status = wire::TrackingStatus::kWeak;
  progress.stream.last_result->reason = "too near";
  EXPECT_THAT(format_scan_progress(progress),
              AllOf(HasSubstr("weak: too near"), Not(HasSubstr("go back"))));
}

TEST(ScanDisplay, PauseDropsRecordingAndASlowLinkShow) {
  ScanProgress progress = under_way();
  progress.capture.paused = true;
  progress.dropped_frames = 3;
  progress.stream.left_out_frames = 2;
  progress.stream.link_level = 4;
  progress.stream.durable_frames = 1100;
  progress.log = LocalLog::State{.durable_count = 1257};
  const std::string text = format_scan_progress(progress);
  EXPECT_THAT(text, HasSubstr("paused: space goes on"));
  EXPECT_THAT(text, Not(HasSubstr("fps")));
  EXPECT_THAT(text, HasSubstr("3 dropped  2 left out  slow link: colour q70, 2 of 3 frames  1257 "
                              "recorded, 1100 on the server: 157 frames "
                              "behind, catching up"));
  progress.stream.durable_frames = 1240;
  EXPECT_THAT(format_scan_progress(progress),
              testing::EndsWith("1257 recorded, 1240 on the server"));
}

TEST(ScanDisplay, AfterTheLastFrameItSaysHowManyThereAre) {
  ScanProgress progress = under_way();
  progress.capture.ended = true;
  progress.stream.finishing = true;
  EXPECT_THAT(
      format_scan_progress(progress),
      AllOf(testing::StartsWith("0:42  1260 frames  tracked"), testing::EndsWith("  finishing")));
}

TEST(ScanDisplay, NumbersThatCannotBeDoNotBreakIt) {
  ScanProgress progress;
  EXPECT_EQ(format_scan_progress(progress), "0:00  0.0 fps  0 % depth");
  progress = under_way();
  progress.stream.last_result->timestamp_s = -1e300;
  progress.stream.last_result->status = wire::TrackingStatus::kLost;
  progress.stream.last_result->last_tracked = wire::TrackedFrame{0, 1e300};
  EXPECT_LT(format_scan_progress(progress).size(), 200u);
}

TEST(ScanDisplay, TheLastLineSumsUp) {
  ScanProgress progress = under_way();
  progress.dropped_frames = 3;
  progress.stream.processed_frames = 1257;
  progress.stream.tracked_frames = 1250;
  EXPECT_EQ(format_scan_summary(progress, ""),
            "1260 frames in 42 s, 3 dropped; scan 4f: 1257 processed, 1250 tracked");
  progress.stream.scan_id.clear();
  progress.log = LocalLog::State{.durable_count = 1257, .bytes = 126'000'000};
  EXPECT_EQ(format_scan_summary(progress, "kitchen"),
            "1260 frames in 42 s, 3 dropped, 1257 recorded in kitchen (126.0 MB)");
}

}  // namespace
}  // namespace hermite::client::scan_display_test
