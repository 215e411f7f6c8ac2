#include "core/track/pose_choice.h"

#include <gtest/gtest.h>

namespace hermite::track::pose_choice_test {
namespace {

OdometryResult result(double x_m, double overlap, double correlation) {
  OdometryResult result;
  result.reference_from_camera.translation.x() = x_m;
  result.agreement = {.surface = 1,
                      .overlap = overlap,
                      .agreeing = 1,
                      .correlation = correlation,
                      .grey_deviation = 14,
                      .reference_grey_deviation = 14,
                      .sharpness = 1};
  return result;
}

double best_x_m(std::vector<OdometryResult> poses) {
  return best_pose(std::move(poses), TrackOptions{}).reference_from_camera.translation.x();
}
bool is_ambiguous(std::vector<OdometryResult> poses) {
  return best_pose(std::move(poses), TrackOptions{}).is_ambiguous;
}

TEST(PoseChoice, AnImageThatFitsWellOutweighsALargerOverlap) {
  EXPECT_EQ(best_x_m({result(0.7, 0.68, 0.84), result(0.3, 0.55, 0.98)}), 0.3);
  EXPECT_FALSE(is_ambiguous({result(0.7, 0.68, 0.84), result(0.3, 0.55, 0.98)}));
}

TEST(PoseChoice, WithoutAnImageTheLargerOverlapIsBetterAndANearlyEqualOneARival) {
  std::vector<OdometryResult> poses = {result(0.3, 0.5, 0), result(0.7, 0.7, 0),
                                       result(0.2, 0.65, 0)};
  for (OdometryResult& pose : poses) pose.agreement.grey_deviation = 0;
  EXPECT_EQ(best_x_m(poses), 0.7);
  EXPECT_TRUE(is_ambiguous(poses));
  poses.pop_back();
  EXPECT_FALSE(is_ambiguous(poses));
}

TEST(PoseChoice, WhatIsNotBelievedIsNoRival) {
  OdometryResult rival = result(0.7, 0.6, 0.97);
  rival.agreement.agreeing = 0.6;
  rival.agreement.overlap = 0.99;
  EXPECT_FALSE(is_ambiguous({result(0.3, 0.55, 0.98), rival}));
}

TEST(PoseChoice, ThePoseThatIsThereAlreadyIsNotAddedAgain) {
  std::vector<OdometryResult> poses;
  add_pose(poses, result(0.3, 0.5, 0.9));
  add_pose(poses, result(0.32, 0.5, 0.98));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].agreement.correlation, 0.98) << "the better fit stays";
  add_pose(poses, result(0.33, 0.5, 0.8));
  EXPECT_EQ(poses[0].agreement.correlation, 0.98);
  add_pose(poses, result(0.4, 0.5, 0.9));
  EXPECT_EQ(poses.size(), 2u);
}

}  // namespace
}  // namespace hermite::track::pose_choice_test
