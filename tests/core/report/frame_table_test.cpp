#include "core/report/frame_table.h"

#include <gtest/gtest.h>

namespace hermite::report::frame_table_test {
namespace {

const std::string kHeading =
    "frame,timestamp_s,status,event,correction_m,inlier_ratio,residual_rms_m,surfels,ms,reason,"
    "position_sigma_m,rotation_sigma_deg,"
    "covariance,position_error_m,rotation_error_deg,error_sigmas\n";

TEST(FrameTable, HasAHeadingAndALineAFrame) {
  FrameRow tracked;
  tracked.result.frame_index = 7;
  tracked.result.timestamp_s = 1305031453.359684;
  tracked.result.status = track::TrackingStatus::kTracked;
  tracked.result.event = pipeline::MapEvent::kLoopClosed;
  tracked.result.correction_m = 0.0312;
  tracked.result.inlier_ratio = 0.75;
  tracked.result.residual_rms_m = 0.002;
  tracked.result.surfel_count = 12345;
  tracked.ms = 41.26;
  FrameRow lost;
  lost.result.frame_index = 8;
  lost.result.timestamp_s = 1305031453.4;
  lost.result.status = track::TrackingStatus::kLost;
  lost.result.event = pipeline::MapEvent::kLost;
  lost.result.reason = "too few points: 3 %, at least 5 % are needed";
  tracked.result.uncertainty = track::PoseUncertainty{1e-4 * Matrix6d::Identity(), 0};
  const std::string covariance =
      "1.0000e-04 0.0000e+00 0.0000e+00 0.0000e+00 0.0000e+00 0.0000e+00 1.0000e-04 0.0000e+00 "
      "0.0000e+00 0.0000e+00 0.0000e+00 "
      "1.0000e-04 0.0000e+00 0.0000e+00 0.0000e+00 1.0000e-04 0.0000e+00 0.0000e+00 1.0000e-04 "
      "0.0000e+00 1.0000e-04";
  EXPECT_EQ(format_frame_table({tracked, lost}),
            kHeading +
                "7,1305031453.359684,tracked,loop "
                "closed,0.0312,0.7500,0.002000,12345,41.3,\"\",0.010000,0.57296," +
                covariance +
                ",,,\n"
                "8,1305031453.400000,lost,lost,0.0000,0.0000,0.000000,0,0.0,\"too few points: 3 %, "
                "at least 5 % are needed\",,,,,,\n");
}

TEST(FrameTable, SaysHowFarPosesAreFromTheTruth) {
  FrameRow first, second;
  first.result.uncertainty = track::PoseUncertainty{};
  second.result = first.result;
  second.result.timestamp_s = 1;
  second.result.uncertainty->second_moment = 1e-4 * Matrix6d::Identity();
  second.result.world_from_camera.translation.x() = 0.02;
  const std::string table = format_frame_table({first, second}, {{0, Rigid3{}}, {1, Rigid3{}}});
  EXPECT_TRUE(table.ends_with(",0.020000,0.00000,2.000\n")) << table;
}

TEST(FrameTable, IsAHeadingWhenThereAreNoFrames) { EXPECT_EQ(format_frame_table({}), kHeading); }

}  // namespace
}  // namespace hermite::report::frame_table_test
