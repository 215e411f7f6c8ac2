#include "core/adjust/rigid_ransac.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/core/adjust/point_world.h"

namespace hermite::adjust {
namespace {

using test::normal;

const Rigid3 kPose = exp_se3((Vector6d() << 1, -0.5, 2, 0.3, -1.2, 0.4).finished());

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

// `right` pairs that the pose explains up to `sigmas` of noise, then `wrong` ones of points that
// have nothing to do with each other.
std::vector<PointPair> pairs_of(std::size_t right, std::size_t wrong, double sigmas,
                                std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  const Camera camera = test::point_camera();
  const auto any_point = [&] {
    return camera.unproject(uniform(random, 20, 620), uniform(random, 20, 460),
                            uniform(random, 0.6, 4));
  };
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < right + wrong; ++i) {
    const Eigen::Vector3d truth = any_point();
    const double depth_m = truth.z() + sigmas * depth_deviation_m(truth.z()) * normal(random);
    const Eigen::Vector2d pixel_px =
        camera.project(truth) + sigmas * Eigen::Vector2d(normal(random), normal(random));
    const Eigen::Vector3d measured = camera.unproject(pixel_px.x(), pixel_px.y(), depth_m);
    pairs.push_back({measured, kPose * (i < right ? truth : any_point()), 1, 0});
  }
  return pairs;
}

double error_m(const Rigid3& pose) { return (inverse(kPose) * pose).translation.norm(); }
double error_rad(const Rigid3& pose) { return angle_rad((inverse(kPose) * pose).rotation); }

TEST(MatchRigidly, ExactPairsGiveTheExactPose) {
  const auto match = match_rigidly(pairs_of(20, 0, 0), test::point_camera());
  ASSERT_TRUE(match);
  EXPECT_EQ(match->inliers.size(), 20u);
  EXPECT_LT(error_m(match->world_from_camera), 1e-9);
  EXPECT_LT(error_rad(match->world_from_camera), 1e-9);
}

TEST(MatchRigidly, FindsTheFewRightPairsAmongManyWrongOnes) {
  const auto match = match_rigidly(pairs_of(40, 160, 1), test::point_camera());
  ASSERT_TRUE(match);
  const auto right = std::count_if(match->inliers.begin(), match->inliers.end(),
                                   [](std::uint32_t i) { return i < 40; });
  EXPECT_GE(right, 36);  // three standard deviations in three directions leave out 1 of 100
  EXPECT_LE(match->inliers.size() - static_cast<std::size_t>(right), 1u);
  EXPECT_TRUE(std::is_sorted(match->inliers.begin(), match->inliers.end()));
  // 40 points of 1 px at f = 525 px: sideways below 1 mm, in depth 2 mm (sigma 5 to 40 mm over the
  // root of 40).
  EXPECT_LT(error_m(match->world_from_camera), 0.008);
  EXPECT_LT(error_rad(match->world_from_camera), 0.004);
}

TEST(MatchRigidly, WrongPairsAloneAreNoPlace) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    EXPECT_FALSE(match_rigidly(pairs_of(0, 200, 1, seed), test::point_camera()));
}

TEST(MatchRigidly, TooFewInliersAreNone) {
  EXPECT_FALSE(match_rigidly(pairs_of(14, 0, 0), test::point_camera()));
  RansacOptions options;
  options.least_inliers = 14;
  EXPECT_TRUE(match_rigidly(pairs_of(14, 0, 0), test::point_camera(), options));
  EXPECT_FALSE(match_rigidly({}, test::point_camera()));
}

TEST(MatchRigidly, PointsOnALineFixNoPose) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d point(0.02 * i - 0.4, 0.1, 1.5);
    pairs.push_back({point, kPose * point, 1, 0});
  }
  EXPECT_FALSE(match_rigidly(pairs, test::point_camera()));
}

TEST(MatchRigidly, AMirroredSceneIsNotTheSame) {
  std::vector<PointPair> pairs = pairs_of(60, 0, 0);
  for (PointPair& pair : pairs) pair.point_in_world_m.x() *= -1;
  EXPECT_FALSE(match_rigidly(pairs, test::point_camera()));
}

TEST(MatchRigidly, NonsenseIsLeftOut) {
  std::vector<PointPair> pairs = pairs_of(30, 0, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  pairs[3].point_in_camera_m.x() = nan;
  pairs[4].point_in_world_m.z() = infinity;
  pairs[5].point_in_camera_m *= -1;
  pairs[6].pixel_sigma_px = 0;
  pairs[7].world_sigma_m = nan;
  const auto match = match_rigidly(pairs, test::point_camera());
  ASSERT_TRUE(match);
  EXPECT_EQ(match->inliers.size(), 25u);
  EXPECT_EQ(match->inliers[3], 8u);
}

TEST(MatchRigidly, TheSameSeedGivesTheSameAnswer) {
  const std::vector<PointPair> pairs = pairs_of(40, 160, 1);
  const auto first = match_rigidly(pairs, test::point_camera()),
             second = match_rigidly(pairs, test::point_camera());
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->inliers, second->inliers);
  EXPECT_EQ(first->world_from_camera.matrix(), second->world_from_camera.matrix());
}

// A far point may be wrong by more than a near one.
TEST(RefineRigidly, TheDepthGateGrowsWithTheNoise) {
  std::vector<PointPair> pairs = pairs_of(30, 0, 0);
  const Camera camera = test::point_camera();
  const auto add = [&](double depth_m, double error_m) {
    const Eigen::Vector3d truth = camera.unproject(300, 200, depth_m);
    pairs.push_back({camera.unproject(300, 200, depth_m + error_m), kPose * truth, 1, 0});
  };
  add(1.0, 0.025);
  add(3.5, 0.025);
  const auto match = refine_rigidly(pairs, camera, kPose, 15);
  ASSERT_TRUE(match);
  EXPECT_FALSE(std::binary_search(match->inliers.begin(), match->inliers.end(), 30u));
  EXPECT_TRUE(std::binary_search(match->inliers.begin(), match->inliers.end(), 31u));
}

TEST(RefineRigidly, PullsAGuessToTheTruth) {
  const Rigid3 guess =
      kPose * exp_se3((Vector6d() << 0.003, -0.002, 0.004, 0.002, 0.001, -0.002).finished());
  const auto match = refine_rigidly(pairs_of(100, 0, 0), test::point_camera(), guess, 15);
  ASSERT_TRUE(match);
  EXPECT_EQ(match->inliers.size(), 100u);
  EXPECT_LT(error_m(match->world_from_camera), 1e-9);
}

}  // namespace
}  // namespace hermite::adjust
