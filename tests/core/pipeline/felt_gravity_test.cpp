#include "core/pipeline/felt_gravity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hermite::pipeline::felt_gravity_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kDegree = M_PI / 180, kGravity_m_s2 = 9.80665;
const Eigen::Vector3d kUp = Eigen::Vector3d(0.1, -0.9, -0.4).normalized();
const Eigen::Vector3d kBias_m_s2(0.3, -0.1, 0.2);

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double degrees) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kDegree, axis.normalized()));
}

// A walk with the camera in a hand, 30 frames a second.
struct Walk {
  int frames = 600;
  double turn_deg = 120;  // over all of it, about an axis that wanders
  Eigen::Vector3d bias_m_s2 = kBias_m_s2;
  double hand_m_s2 = 1;
  std::uint32_t submap = 0;
  Rigid3 world_from_submap{};
};

Eigen::Quaterniond world_from_camera(const Walk& walk, int frame) {
  const double share = static_cast<double>(frame) / walk.frames;
  return about(Eigen::Vector3d::UnitY(), walk.turn_deg * share) *
         about(Eigen::Vector3d::UnitX(), walk.turn_deg / 3 * std::sin(6 * share));
}

AnchoredPose pose_of(const Walk& walk, int frame) {
  AnchoredPose pose{frame / 30.0, walk.submap, {}, track::TrackingStatus::kTracked, 0};
  pose.submap_from_camera.rotation =
      walk.world_from_submap.rotation.conjugate() * world_from_camera(walk, frame);
  return pose;
}

// A hand swings to and fro once a second, so that half a second is one motion.
Eigen::Vector3d felt_of(const Walk& walk, int frame) {
  const double phase = 2 * M_PI * frame / 30.0;
  const Eigen::Vector3d in_world_m_s2 =
      kGravity_m_s2 * kUp +
      walk.hand_m_s2 * Eigen::Vector3d(std::sin(phase), std::cos(phase), std::sin(1.3 * phase));
  return world_from_camera(walk, frame).conjugate() * in_world_m_s2 + walk.bias_m_s2;
}

FeltGravity felt_on(const Walk& walk) {
  FeltGravity gravity;
  for (int i = 0; i < walk.frames; ++i) gravity.add(felt_of(walk, i), pose_of(walk, i));
  return gravity;
}

double error_rad(const FeltUp& felt) {
  return felt.up ? std::acos(std::min(1.0, felt.up->in_world.dot(kUp))) : M_PI;
}

TEST(FeltGravity, TheBiasIsSeenWhenTheCameraTurns) {
  const FeltUp turned = felt_on({}).in_world({}), still = felt_on({.turn_deg = 0}).in_world({});
  ASSERT_TRUE(turned.up && still.up) << turned.problem << still.problem;
  EXPECT_THAT(turned.problem, IsEmpty());
  EXPECT_NEAR(turned.up->in_world.norm(), 1, 1e-9);
  EXPECT_LT(error_rad(turned), 0.5 * kDegree);
  EXPECT_LT(turned.up->sigma_rad, 1.5 * kDegree);
  // What a bias of 0.3 across gravity tilts.
  EXPECT_GT(error_rad(still), 1 * kDegree);
  EXPECT_GT(still.up->sigma_rad, 2 * kDegree);
  EXPECT_LT(error_rad(still), 2 * still.up->sigma_rad);
}

TEST(FeltGravity, TheTruthIsWithinTheDeviationStated) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  int inside = 0;
  constexpr int kWalks = 200;
  for (int i = 0; i < kWalks; ++i) {
    Walk walk;
    walk.frames = 20 + static_cast<int>(random() % 400);
    walk.turn_deg = static_cast<double>(random() % 180);
    for (double& component : walk.bias_m_s2) component = 0.25 * normal(random);
    walk.hand_m_s2 = std::abs(normal(random));
    const FeltUp felt = felt_on(walk).in_world({});
    ASSERT_TRUE(felt.up) << felt.problem;
    // The deviation is that of the worse direction: of a plane error 39 % would be inside at least.
    inside += error_rad(felt) < 2 * felt.up->sigma_rad ? 1 : 0;
  }
  EXPECT_GE(inside, kWalks * 95 / 100);
}

TEST(FeltGravity, FollowsCorrectionsOfTheMap) {
  Walk first, second;
  second.submap = 1;
  second.world_from_submap.rotation = about({1, 0, 1}, 25);
  FeltGravity gravity;
  for (int i = 0; i < first.frames; ++i) {
    const Walk& walk = i < 300 ? first : second;
    gravity.add(felt_of(walk, i), pose_of(walk, i));
  }
  adjust::MapLayout layout;
  layout.world_from_submap = {Rigid3{}, second.world_from_submap};
  layout.component = {0, 0};
  const double as_it_was_rad = error_rad(gravity.in_world(layout));
  EXPECT_LT(as_it_was_rad, 0.5 * kDegree);
  // The second submap turns out to lie 10 degrees off.
  layout.world_from_submap[1].rotation = about({0, 0, 1}, 10) * second.world_from_submap.rotation;
  EXPECT_GT(error_rad(gravity.in_world(layout)), 2 * kDegree);
}

TEST(FeltGravity, OfPartsTheLargestSpeaks) {
  Walk small, large;
  small.frames = 100;
  large.submap = 1;
  FeltGravity gravity = felt_on(small);
  for (int i = 0; i < large.frames; ++i) gravity.add(felt_of(large, i), pose_of(large, i));
  adjust::MapLayout layout;
  layout.world_from_submap = {Rigid3{about({1, 0, 0}, 90), {0, 0, 0}}, Rigid3{}};
  layout.component = {0, 1};
  EXPECT_LT(error_rad(gravity.in_world(layout)), 1 * kDegree);
}

TEST(FeltGravity, WhatDoesNotBelongToTheCameraIsRefusedInWords) {
  const auto felt_as = [](const Eigen::Matrix3d& axes) {
    FeltGravity gravity;
    for (int i = 0; i < 600; ++i) gravity.add(axes * felt_of({}, i), pose_of({}, i));
    return gravity.in_world({});
  };
  const FeltUp in_g = felt_as(Eigen::Matrix3d::Identity() / kGravity_m_s2);
  EXPECT_FALSE(in_g.up);
  EXPECT_THAT(in_g.problem, HasSubstr("feels 1.0 m/s^2 upwards instead of 9.8"));
  const FeltUp turned = felt_as(about({1, 0, 0}, 90).toRotationMatrix());
  EXPECT_FALSE(turned.up);
  EXPECT_THAT(turned.problem, HasSubstr("accelerometer"));
  const FeltUp upside_down = felt_as(Eigen::Vector3d(-1, -1, 1).asDiagonal());
  EXPECT_FALSE(upside_down.up);
}

TEST(FeltGravity, WhatIsNoAccelerationAndLostFramesAreIgnored) {
  FeltGravity gravity = felt_on({});
  const FeltUp before = gravity.in_world({});
  AnchoredPose pose = pose_of({}, 599);
  gravity.add(std::nullopt, pose);
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, 200.0})
    gravity.add(Eigen::Vector3d(0, value, 0), pose);
  pose.status = track::TrackingStatus::kLost;
  gravity.add(Eigen::Vector3d(9.8, 0, 0), pose);
  EXPECT_EQ(gravity.in_world({}).up->in_world, before.up->in_world);
  EXPECT_EQ(gravity.in_world({}).up->sigma_rad, before.up->sigma_rad);
}

TEST(FeltGravity, WithoutOneNothingIsSaidAndOfRubbishOnlyWhy) {
  EXPECT_FALSE(FeltGravity().in_world({}).up);
  EXPECT_THAT(FeltGravity().in_world({}).problem, IsEmpty());
  FeltGravity rubbish;
  rubbish.add(Eigen::Vector3d::Constant(std::nan("")), pose_of({}, 0));
  EXPECT_FALSE(rubbish.in_world({}).up);
  EXPECT_THAT(rubbish.in_world({}).problem, HasSubstr("no numbers up to 157 m/s^2"));
}

TEST(FeltGravity, OneFrameGivesAWideAnswer) {
  const FeltUp felt = felt_on({.frames = 1}).in_world({});
  ASSERT_TRUE(felt.up);
  EXPECT_GT(felt.up->sigma_rad, 4 * kDegree);
  EXPECT_LT(error_rad(felt), 3 * felt.up->sigma_rad);
}

}  // namespace
}  // namespace hermite::pipeline::felt_gravity_test
