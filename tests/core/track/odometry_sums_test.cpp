#include "core/track/odometry_sums.h"

#include <gtest/gtest.h>

namespace hermite::track::odometry_sums_test {
namespace {

OdometryTerms counted() {
  OdometryTerms terms;
  for (std::size_t i = 0; i < terms.size(); ++i) terms[i] = static_cast<double>(i) + 1;
  return terms;
}

TEST(OdometrySums, SystemsAreSymmetric) {
  const OdometrySums sums(counted(), 100);
  EXPECT_EQ(sums.geometric.hessian, sums.geometric.hessian.transpose());
  EXPECT_EQ(sums.geometric.hessian(0, 0), 1);
  EXPECT_EQ(sums.geometric.hessian(5, 0), 6);
  EXPECT_EQ(sums.geometric.hessian(5, 5), 21);
  EXPECT_EQ(sums.geometric.right_hand_side[0], 22);
  EXPECT_EQ(sums.photometric.motion.hessian(0, 0), 28);
  EXPECT_EQ(sums.pixel_count, 100);
}

// Two points of weight 1, at (1, 0, 2) and (0, 3, 0).
TEST(OdometrySums, ATwistMovesThePointsByItsDisplacement) {
  OdometryTerms terms{};
  const Eigen::Vector3d points[] = {{1, 0, 2}, {0, 3, 0}};
  for (const Eigen::Vector3d& p : points) {
    const double moments[] = {1,
                              p.x(),
                              p.y(),
                              p.z(),
                              p.x() * p.x(),
                              p.x() * p.y(),
                              p.x() * p.z(),
                              p.y() * p.y(),
                              p.y() * p.z(),
                              p.z() * p.z()};
    for (std::size_t i = 0; i < 10; ++i) terms[shared::kMomentSums + i] += moments[i];
  }
  const Vector6d twist = (Vector6d() << 0.1, -0.2, 0.3, 0.4, 0.5, -0.6).finished();
  double moved2 = 0;
  for (const Eigen::Vector3d& p : points)
    moved2 += (twist.head<3>() + twist.tail<3>().cross(p)).squaredNorm();
  EXPECT_NEAR(twist.dot(OdometrySums(terms, 1).displacement * twist), moved2, 1e-12);
}

TEST(OdometrySums, NormalsDisagreeByTheMeanOverPairsThatAreUsedAndOverAllThatAreNear) {
  OdometryTerms terms{};
  terms[shared::kMomentSums] = 2;
  terms[shared::kDisagreementSum] = 1;
  terms[shared::kNearSums] = 3;
  terms[shared::kNearSums + 1] = 12;
  const OdometrySums sums(terms, 1);
  EXPECT_EQ(sums.disagreement, 0.5);
  EXPECT_EQ(sums.near_disagreement, 0.25);
}

TEST(OdometrySums, NothingSeenIsNothingKnown) {
  const OdometrySums sums(OdometryTerms{}, 100);
  EXPECT_EQ(sums.geometric_unit(), 0);
  EXPECT_EQ(sums.photometric_unit(), 0);
  EXPECT_EQ(sums.geometric_spread2, 0);
  EXPECT_EQ(sums.disagreement, 0);
  EXPECT_EQ(sums.near_disagreement, 0);
}

}  // namespace
}  // namespace hermite::track::odometry_sums_test
