#include "core/report/frame_table.h"

#include <gtest/gtest.h>

namespace hermite {
namespace {

TEST(FrameTable, HasAHeadingAndALineAFrame) {
  FrameRow tracked;
  tracked.result.frame_index = 7;
  tracked.result.timestamp_s = 1305031453.359684;
  tracked.result.status = TrackingStatus::kTracked;
  tracked.result.event = MapEvent::kLoopClosed;
  tracked.result.correction_m = 0.0312;
  tracked.result.inlier_ratio = 0.75;
  tracked.result.residual_rms_m = 0.002;
  tracked.result.surfel_count = 12345;
  tracked.ms = 41.26;
  FrameRow lost;
  lost.result.frame_index = 8;
  lost.result.timestamp_s = 1305031453.4;
  lost.result.status = TrackingStatus::kLost;
  lost.result.event = MapEvent::kLost;
  lost.result.reason = "too few points: 3 %, at least 5 % are needed";
  EXPECT_EQ(format_frame_table({tracked, lost}),
            "frame,timestamp_s,status,event,correction_m,inlier_ratio,residual_rms_m,surfels,ms,reason\n"
            "7,1305031453.359684,tracked,loop closed,0.0312,0.7500,0.002000,12345,41.3,\"\"\n"
            "8,1305031453.400000,lost,lost,0.0000,0.0000,0.000000,0,0.0,\"too few points: 3 %, at least 5 % are needed\"\n");
}

TEST(FrameTable, IsAHeadingWhenThereAreNoFrames) {
  EXPECT_EQ(format_frame_table({}), "frame,timestamp_s,status,event,correction_m,inlier_ratio,residual_rms_m,surfels,ms,reason\n");
}

}  // namespace
}  // namespace hermite
