#include "core/track/pose_guesses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hermite::track::pose_guesses_test {
namespace {

const Rigid3 kTurned = exp_se3((Vector6d() << 0, 0, 0, 0.1, 0, 0).finished());
const Rigid3 kLastMotion = exp_se3((Vector6d() << 0.02, 0, 0, 0, 0.05, 0).finished());

TEST(PoseGuesses, CornersComeFirstAndTheLastMotionIsContinued) {
  FeatureMotion corners;
  corners.earlier_from_frame = exp_se3((Vector6d() << 0, 0.03, 0, 0, 0, 0).finished());
  const std::vector<Rigid3> guesses = pose_guesses(kTurned, kLastMotion, &corners, TrackOptions{});
  ASSERT_EQ(guesses.size(), 2u);
  EXPECT_EQ(guesses[0].translation, corners.earlier_from_frame.translation);
  EXPECT_EQ(guesses[1].translation, kLastMotion.translation);
}

TEST(PoseGuesses, WithoutCornersTheRotationIsAlsoTriedWithTheLastTranslation) {
  const std::vector<Rigid3> guesses = pose_guesses(kTurned, kLastMotion, nullptr, TrackOptions{});
  ASSERT_EQ(guesses.size(), 3u);
  EXPECT_EQ(guesses[0].translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(guesses[2].translation, kLastMotion.translation);
  EXPECT_EQ(guesses[2].rotation.coeffs(), kTurned.rotation.coeffs());
}

TEST(PoseGuesses, ALostCameraLooksAllAround) {
  const std::vector<Rigid3> guesses = with_turns({kTurned});
  ASSERT_EQ(guesses.size(), 16u);
  EXPECT_EQ(guesses[0].rotation.coeffs(), kTurned.rotation.coeffs());
  double widest_rad = 0;
  for (const Rigid3& guess : guesses) widest_rad = std::max(widest_rad, angle_rad(guess.rotation));
  EXPECT_NEAR(widest_rad * 180 / M_PI, 21.6, 0.2);
}

}  // namespace
}  // namespace hermite::track::pose_guesses_test
