#include "core/compare/start_poses.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/compare/alignment.h"
#include "core/compare/surface_features.h"
#include "tests/core/compare/made_corner.h"

namespace hermite::compare::start_poses_test {

struct TwoScans {
  ComparedScan a = test::corner_scan(test::usual_boxes(), 1),
               b = test::corner_scan(test::usual_boxes(), 2, test::elsewhere());
  CoarseScan coarse_a{a, coarse_spacing_m(a, b)}, coarse_b{b, coarse_spacing_m(a, b)};
  Rigid3 a_from_b = inverse(test::elsewhere());
};

const TwoScans& scans() {
  static const TwoScans two;
  return two;
}

bool has_the_right_one(const std::vector<Rigid3>& poses) {
  return std::any_of(poses.begin(), poses.end(), [](const Rigid3& pose) {
    return is_same_pose(pose, scans().a_from_b, scans().coarse_b);
  });
}

TEST(StartPoses, FeaturesFindThePlaceWithoutAGuess) {
  const double reach_m = 6 * scans().coarse_a.spacing_m();
  const auto in_a = surface_features(scans().coarse_a.samples(), reach_m, 1000, false),
             in_b = surface_features(scans().coarse_b.samples(), reach_m, 1000, false);
  EXPECT_EQ(in_a.size(), 1000u);
  const std::vector<FeaturePair> pairs = similar_features(in_a, in_b, 3);
  EXPECT_EQ(pairs.size(), 3 * in_b.size());
  EXPECT_TRUE(has_the_right_one(poses_by_features(scans().coarse_a, scans().coarse_b, pairs, 8)));
  EXPECT_TRUE(poses_by_features(scans().coarse_a, scans().coarse_b, {}, 8).empty());
}

TEST(StartPoses, PlanesFindThePlaceWithoutAGuess) {
  const std::vector<Rigid3> all = poses_by_planes(scans().coarse_a, scans().coarse_b);
  EXPECT_GE(all.size(), 24u);
  const std::vector<Rigid3> best = best_poses(scans().coarse_a, scans().coarse_b, all, 8);
  EXPECT_LE(best.size(), 8u);
  EXPECT_TRUE(has_the_right_one(best));
}

TEST(StartPoses, TurnsAreAboutTheMainDirections) {
  const std::vector<Rigid3> turned = turned_poses(scans().a_from_b, scans().coarse_a);
  EXPECT_EQ(turned.size(), 9u);
  for (const Rigid3& pose : turned)
    EXPECT_GT(angle_rad(pose.rotation.conjugate() * scans().a_from_b.rotation), 1.5);
}

TEST(Alignment, IsAsAccurateAsItSays) {
  Vector6d off;
  off << 0.02, -0.015, 0.02, 0.05, -0.04, 0.06;
  const Rigid3 rough =
      aligned_roughly(scans().coarse_a, scans().coarse_b, exp_se3(off) * scans().a_from_b, 1000);
  EXPECT_TRUE(is_same_pose(rough, scans().a_from_b, scans().coarse_b));
  const ScanAlignment exact = aligned_exactly(scans().coarse_a, scans().coarse_b, rough);
  EXPECT_GT(exact.place_count, 1000u);
  const Vector6d error = log_se3(exact.a_from_b * test::elsewhere());
  EXPECT_LT(error.head<3>().norm(), 0.0005);
  EXPECT_LT(error.tail<3>().norm(), 0.001);
  EXPECT_LT(error.dot(exact.covariance.ldlt().solve(error)), 22.5)
      << "the 99.9 % quantile of six degrees of freedom";
  EXPECT_LT(exact.weakest_sigma_m, 0.001);
  EXPECT_LT(exact.disagreement_m, 0.001);
}

TEST(Agreement, CountsWhatBothSawAndWhatContradicts) {
  const CoarseAgreement right = agreement_of(scans().coarse_a, scans().coarse_b, scans().a_from_b);
  EXPECT_GT(right.share(), 0.97);
  EXPECT_GT(right.overlap(), 0.9);
  EXPECT_TRUE(right.has_color);
  EXPECT_LT(right.color_difference, 5);
  const CoarseAgreement wrong =
      agreement_of(scans().coarse_a, scans().coarse_b,
                   Rigid3{Eigen::Quaterniond::Identity(), {0.35, 0, 0}} * scans().a_from_b);
  EXPECT_LT(wrong.share(), right.share() - 0.05);
  const CoarseAgreement apart = agreement_of(scans().coarse_a, scans().coarse_b,
                                             Rigid3{Eigen::Quaterniond::Identity(), {50, 0, 0}});
  EXPECT_EQ(apart.matched + apart.contradicted, 0u);
  EXPECT_EQ(apart.share(), 0);
}

}  // namespace hermite::compare::start_poses_test
