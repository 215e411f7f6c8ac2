#include "core/report/stated_uncertainty.h"

#include <gtest/gtest.h>

namespace hermite::report::stated_uncertainty_test {
namespace {

Rigid3 beside(double x_m) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, 0, 0)}; }

FrameRow row(double timestamp_s, double x_m, double sigma_m) {
  FrameRow row;
  row.result.timestamp_s = timestamp_s;
  row.result.world_from_camera = beside(x_m);
  row.result.status = track::TrackingStatus::kTracked;
  row.result.uncertainty = track::PoseUncertainty{sigma_m * sigma_m * Matrix6d::Identity(), 0};
  return row;
}

// The true world is another than the estimated one: turned, and a metre away.
dataset::Trajectory truth(int count) {
  const Rigid3 true_world_from_world = exp_se3((Vector6d() << 1, 0, 0, 0, 0, 1).finished());
  dataset::Trajectory poses;
  for (int i = 0; i < count; ++i)
    poses.push_back({0.1 * i, true_world_from_world * beside(0.1 * i)});
  return poses;
}

TEST(StatedUncertainty, IsOfPosesRelativeToTheFirst) {
  const std::vector<FrameRow> rows{row(0, 0, 0), row(0.1, 0.13, 0.01), row(0.2, 0.2, 0.01)};
  const auto errors = stated_errors(rows, truth(3));
  ASSERT_EQ(errors.size(), 3u);
  EXPECT_FALSE(errors[0]) << "the world";
  ASSERT_TRUE(errors[1] && errors[2]);
  EXPECT_NEAR(errors[1]->position_m, 0.03, 1e-9);
  EXPECT_NEAR(errors[1]->pose_sigmas, 3, 1e-3);
  EXPECT_NEAR(errors[1]->position_sigmas, 3, 1e-3);
  EXPECT_NEAR(errors[2]->pose_sigmas, 0, 1e-3);
}

TEST(StatedUncertainty, CountsWhatIsInsideAndWhatIsWrong) {
  std::vector<FrameRow> rows{row(0, 0, 0), row(0.1, 0.13, 0.01), row(0.2, 0.25, 0.01),
                             row(0.3, 0.36, 0.1), row(0.4, 0.5, 0.01)};
  rows[4].result.status = track::TrackingStatus::kWeak;
  rows[4].result.world_from_camera = beside(0.9);
  const StatedShare share = share_inside(rows, stated_errors(rows, truth(5)));
  EXPECT_EQ(share.frame_count, 4);
  EXPECT_EQ(share.inside_count, 2);
  EXPECT_EQ(share.tracked_count, 3);
  EXPECT_EQ(share.tracked_inside_count, 2) << "3 and 0.6 deviations are, 5 are not";
  EXPECT_EQ(share.tracked_wrong_count, 1)
      << "60 mm, however uncertain; 50 mm are 5 deviations and no more";
}

TEST(StatedUncertainty, LostFramesAndOthersWithoutTruthAreLeftOut) {
  std::vector<FrameRow> rows{row(0, 0, 0), row(0.1, 0.1, 0.01), row(7, 0.1, 0.01)};
  rows[1].result.uncertainty.reset();
  rows[1].result.status = track::TrackingStatus::kLost;
  for (const auto& error : stated_errors(rows, truth(3))) EXPECT_FALSE(error);
  EXPECT_EQ(share_inside(rows, stated_errors(rows, {})).frame_count, 0);
}

TEST(StatedUncertainty, APartBeginsAWorldOfItsOwn) {
  std::vector<FrameRow> rows{row(0, 0, 0), row(0.1, 5, 0.01), row(0.2, 5.1, 0.01),
                             row(0.3, 5.2, 0.01)};
  rows[1].result.event = pipeline::MapEvent::kNewPart;
  rows[3].result.event = pipeline::MapEvent::kJoined;
  const auto errors = stated_errors(rows, truth(4));
  EXPECT_FALSE(errors[1]);
  ASSERT_TRUE(errors[2]);
  EXPECT_NEAR(errors[2]->position_m, 0, 1e-9);
  EXPECT_FALSE(errors[3]);
}

}  // namespace
}  // namespace hermite::report::stated_uncertainty_test
