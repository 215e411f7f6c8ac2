#include "server/client/progress.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::client {
namespace {

using testing::HasSubstr;
using testing::Not;

StreamProgress half_way() {
  StreamProgress progress;
  progress.frame_count = 100;
  progress.sent_frames = 54;
  progress.processed_frames = 50;
  progress.sent_bytes = 25'000'000;
  progress.elapsed_s = 20;
  progress.last_result = wire::FrameResult{};
  progress.last_result->status = wire::TrackingStatus::kTracked;
  progress.last_result->world_from_camera.translation = {0.126, -0.001, 2};
  return progress;
}

TEST(Progress, SaysHowFarHowFastWhereAndHowLong) {
  StreamProgress told = half_way();
  told.last_result->uncertainty = wire::PoseUncertainty{0.004, 0};
  EXPECT_THAT(format_progress(told), HasSubstr("  tracked +-8 mm  "));
  told.last_result->uncertainty = wire::PoseUncertainty{0.0111, 0};
  EXPECT_THAT(format_progress(told), HasSubstr("  tracked +-2 cm  "));
  told.last_result->uncertainty = wire::PoseUncertainty{1e300, 0};
  EXPECT_THAT(format_progress(told), HasSubstr("  tracked +-100000 cm  "));
  EXPECT_EQ(format_progress(half_way()),
            "frame 50/100 (sent 54)  2.5 fps  10.0 Mbit/s  position 0.13 0.00 2.00 m  tracked  20 "
            "s left");
}

TEST(Progress, LostFramesDropsAndProblemsShow) {
  StreamProgress progress = half_way();
  progress.last_result->status = wire::TrackingStatus::kLost;
  progress.last_result->reason = "too fast";
  progress.dropped_frames = 2;
  progress.server_dropped_frames = 3;
  progress.left_out_frames = 4;
  progress.link_level = 4;
  progress.problem_frames = 1;
  const std::string text = format_progress(progress);
  EXPECT_THAT(text, HasSubstr("LOST: too fast"));
  EXPECT_THAT(text, HasSubstr("5 dropped  4 left out"));
  EXPECT_THAT(text, HasSubstr("slow link: colour q70, 2 of 3 frames"));
  EXPECT_THAT(text, HasSubstr("1 with problems"));
  EXPECT_THAT(text, HasSubstr("16 s left"));
}

TEST(Progress, ALostCameraIsToldWhereToGoBackTo) {
  StreamProgress progress = half_way();
  progress.last_result->status = wire::TrackingStatus::kLost;
  progress.last_result->reason = "too fast";
  progress.last_result->timestamp_s = 14.2;
  EXPECT_THAT(format_progress(progress), Not(HasSubstr("go back"))) << "nothing was seen yet";
  progress.last_result->last_tracked = wire::TrackedFrame{300, 10};
  EXPECT_THAT(format_progress(progress),
              HasSubstr("LOST: too fast - go back to what was seen 4 s ago"));
  progress.last_result->status = wire::TrackingStatus::kTracked;
  EXPECT_THAT(format_progress(progress), Not(HasSubstr("go back")));
}

TEST(Progress, WhatHappenedToTheMapIsSaidInAMessage) {
  wire::FrameResult result;
  result.sequence = 420;
  result.correction_m = 0.031;
  EXPECT_EQ(format_event(result), "");
  result.event = wire::MapEvent::kLoopClosed;
  EXPECT_EQ(format_event(result), "frame 420: loop closed: the map was corrected by up to 3 cm");
  result.correction_m = 0.001;
  EXPECT_EQ(format_event(result), "frame 420: loop closed: the map was right");
  result.event = wire::MapEvent::kLost;
  result.reason = "too fast";
  EXPECT_EQ(format_event(result), "frame 420: lost: too fast");
  result.event = wire::MapEvent::kFoundAgain;
  EXPECT_EQ(format_event(result), "frame 420: found again");
  result.event = wire::MapEvent::kNewPart;
  EXPECT_EQ(format_event(result),
            "frame 420: a new part of the map begins: it will be joined when the camera sees both");
  result.event = wire::MapEvent::kJoined;
  EXPECT_EQ(format_event(result), "frame 420: two parts of the map are joined");
}

TEST(Progress, BeforeTheFirstResultItMakesNoPromises) {
  StreamProgress progress;
  progress.frame_count = 10;
  progress.sent_bytes = 300;  // the hello
  progress.elapsed_s = 1e-6;
  EXPECT_EQ(format_progress(progress), "frame 0/10 (sent 0)  0.0 fps  0.0 Mbit/s");
}

TEST(Progress, AfterTheLastResultItSaysFinishing) {
  StreamProgress progress = half_way();
  progress.finishing = true;
  EXPECT_THAT(format_progress(progress), HasSubstr("left"));
  progress.processed_frames = progress.sent_frames;
  EXPECT_THAT(format_progress(progress), HasSubstr("finishing"));
  EXPECT_THAT(format_progress(progress), Not(HasSubstr("left")));
}

TEST(Progress, TheSummaryCountsWhatWentWrongOnlyWhenSomethingDid) {
  StreamProgress progress = half_way();
  progress.scan_id = "4f";
  progress.tracked_frames = 49;
  EXPECT_EQ(format_summary(progress),
            "scan 4f is finished: 54 frames sent in 20 s, 49 tracked, 10.0 Mbit/s");
  progress.dropped_frames = 3;
  progress.problem_frames = 2;
  EXPECT_THAT(format_summary(progress), HasSubstr("49 tracked, 3 dropped, 2 with problems,"));
  progress.last_message = "the map is in 2 parts";
  EXPECT_THAT(format_summary(progress), HasSubstr("Mbit/s; the map is in 2 parts"));
}

TEST(Progress, DurationsReadLikeAClock) {
  EXPECT_EQ(format_duration(0), "0 s");
  EXPECT_EQ(format_duration(59.4), "59 s");
  EXPECT_EQ(format_duration(59.6), "1:00");
  EXPECT_EQ(format_duration(456), "7:36");
  EXPECT_EQ(format_duration(7509), "2:05:09");
  EXPECT_EQ(format_duration(-1), "0 s");
  EXPECT_EQ(format_duration(1e300), "100:00:00");
}

TEST(ProgressPrinter, OffATerminalItWritesAPlainLineEveryFewSeconds) {
  std::ostringstream out;
  ProgressPrinter printer(out, false);
  StreamProgress progress = half_way();
  for (int k = 0; k < 120; ++k) {
    progress.elapsed_s = 0.1 * k;
    printer.show(progress);
  }
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);  // at 0, 5 and 10 s
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

TEST(ProgressPrinter, OnATerminalItRewritesOneLineAndKeepsOthers) {
  std::ostringstream out;
  ProgressPrinter printer(out, true);
  printer.show_now(half_way());
  printer.line("frame 7: damaged");
  printer.show_now(half_way());
  const std::string line = format_progress(half_way());
  EXPECT_EQ(out.str(), line + "\r\033[Kframe 7: damaged\n" + line);
}

}  // namespace
}  // namespace hermite::client
