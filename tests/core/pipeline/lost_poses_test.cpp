#include "core/pipeline/lost_poses.h"

#include <gtest/gtest.h>

namespace hermite::pipeline::lost_poses_test {
namespace {

Rigid3 at(double x_m) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, 0, 0)}; }

AnchoredPose pose(double timestamp_s, double x_m, track::TrackingStatus status,
                  std::uint32_t submap = 0) {
  return {timestamp_s, submap, at(x_m), status, 0};
}

// Two submaps of one component, the second 10 m from the first, and one of another component.
adjust::MapLayout layout() {
  adjust::MapLayout layout;
  layout.world_from_submap = {at(0), at(10), at(20)};
  layout.component = {0, 0, 1};
  return layout;
}

constexpr track::TrackingStatus kTracked = track::TrackingStatus::kTracked,
                                kLost = track::TrackingStatus::kLost;

TEST(LostPoses, LieBetweenTheTrackedOnesByTheirTimes) {
  std::vector<AnchoredPose> poses = {pose(0, 1, kTracked), pose(1, 1, kLost), pose(3, 1, kLost),
                                     pose(4, -7, kTracked, 1)};
  EXPECT_EQ(place_lost_frames(poses, layout()), 1u);
  EXPECT_NEAR(poses[1].submap_from_camera.translation.x(), 1.5, 1e-12);
  EXPECT_NEAR(poses[2].submap_from_camera.translation.x(), 2.5, 1e-12)
      << "of 1 to 3 m: the second submap is 10 m from the first";
  EXPECT_EQ(poses[2].submap, 0u);
  EXPECT_EQ(poses[2].status, kLost);
  EXPECT_EQ(poses[3].submap_from_camera.translation.x(), -7);
}

TEST(LostPoses, StayWhereNothingIsKnownOfTheWay) {
  const std::vector<std::vector<AnchoredPose>> all = {
      {},
      {pose(0, 1, kTracked)},
      {pose(0, 1, kTracked), pose(1, 2, kTracked)},
      {pose(0, 1, kTracked), pose(1, 1, kLost)},
      {pose(0, 0, kLost), pose(1, 0, kLost), pose(2, 5, kTracked)},
      {pose(0, 1, kTracked), pose(1, 1, kLost), pose(2, 5, kTracked, 2)},
  };
  for (std::vector<AnchoredPose> poses : all) {
    const std::vector<AnchoredPose> before = poses;
    EXPECT_EQ(place_lost_frames(poses, layout()), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i)
      EXPECT_EQ(poses[i].submap_from_camera.translation, before[i].submap_from_camera.translation)
          << i;
  }
}

TEST(LostPoses, AnEarlierLossIsNotPlacedAgain) {
  std::vector<AnchoredPose> poses = {pose(0, 0, kTracked), pose(1, 7, kLost), pose(2, 2, kTracked),
                                     pose(3, 3, kTracked)};
  EXPECT_EQ(place_lost_frames(poses, layout()), 4u);
  EXPECT_EQ(poses[1].submap_from_camera.translation.x(), 7);
}

}  // namespace
}  // namespace hermite::pipeline::lost_poses_test
