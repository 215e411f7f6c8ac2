#include "core/dataset/trajectory_formats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::dataset {
namespace {

using ::testing::ElementsAre;

TimedPose quarter_turn_about_z() {
  return {0.5,
          {Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), {1, 2, 3}}};
}

TEST(TrajectoryFormats, KittiHasThreeRowsInALine) {
  EXPECT_EQ(format_kitti_trajectory({TimedPose{}}),
            "1.000000000 0.000000000 0.000000000 0.000000000 0.000000000 1.000000000 0.000000000 "
            "0.000000000 0.000000000 0.000000000 "
            "1.000000000 0.000000000\n");
  EXPECT_EQ(format_kitti_trajectory({}), "");
  EXPECT_THAT(format_kitti_trajectory({quarter_turn_about_z()}),
              ::testing::StartsWith("0.000000000 -1.000000000 0.000000000 1.000000000"));
}

TEST(TrajectoryFormats, LogHasTheNumberOfTheFrameAndFourRows) {
  EXPECT_EQ(format_log_trajectory({quarter_turn_about_z()}, {7}),
            "7 7 8\n0.000000000 -1.000000000 0.000000000 1.000000000\n1.000000000 0.000000000 "
            "0.000000000 2.000000000\n"
            "0.000000000 0.000000000 1.000000000 3.000000000\n0.000000000 0.000000000 0.000000000 "
            "1.000000000\n");
}

Trajectory at_places(const std::vector<double>& places) {
  Trajectory trajectory;
  for (const double place : places)
    trajectory.push_back(
        {static_cast<double>(trajectory.size()), {Eigen::Quaterniond::Identity(), {place, 0, 0}}});
  return trajectory;
}

TEST(TrajectoryFormats, LostFramesHaveThePoseOfTheOneBefore) {
  EXPECT_THAT(tracked_frames(at_places({0, 1, 1, 1, 2, 3})),
              ElementsAre(true, true, false, false, true, true));
  EXPECT_THAT(tracked_frames(at_places({0, 0, 0, 1})), ElementsAre(false, false, false, true))
      << "which of them the map began with is not known";
  EXPECT_THAT(tracked_frames(at_places({5})), ElementsAre(true));
  EXPECT_TRUE(tracked_frames({}).empty());
}

}  // namespace
}  // namespace hermite::dataset
