#include "core/math/principal_axes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace hermite {
namespace {

using Eigen::Vector3d;

TEST(PrincipalAxes, OfABoxAreItsEdgesTheLongestFirst) {
  std::vector<Vector3d> corners;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-3.0, 3.0})
      for (const double z : {-2.0, 2.0}) corners.emplace_back(10 + x, y, z);
  const PrincipalAxes axes = principal_axes(corners);
  EXPECT_LT((axes.centre - Vector3d(10, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(std::abs(axes.direction[0].y()), 1, 1e-12);
  EXPECT_NEAR(std::abs(axes.direction[1].z()), 1, 1e-12);
  EXPECT_NEAR(std::abs(axes.direction[2].x()), 1, 1e-12);
  EXPECT_NEAR(axes.deviation[0], 3, 1e-12);
  EXPECT_NEAR(axes.deviation[1], 2, 1e-12);
  EXPECT_NEAR(axes.deviation[2], 1, 1e-12);
}

TEST(PrincipalAxes, FollowTheWeights) {
  const std::vector<Vector3d> points{{0, 0, 0}, {4, 0, 0}, {0, 1000, 0}};
  const std::vector<double> weights{3, 1, 0};
  const PrincipalAxes axes = principal_axes(points, weights);
  EXPECT_LT((axes.centre - Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(std::abs(axes.direction[0].x()), 1, 1e-12);
  EXPECT_NEAR(axes.deviation[0], std::sqrt(3), 1e-12);
  EXPECT_NEAR(axes.deviation[1], 0, 1e-12);
}

TEST(PrincipalAxes, OfOnePointHaveNoExtent) {
  const std::vector<Vector3d> points{{1, 2, 3}};
  const PrincipalAxes axes = principal_axes(points);
  EXPECT_EQ(axes.centre, points[0]);
  EXPECT_EQ(axes.deviation[0], 0);
  EXPECT_NEAR(axes.direction[0].cross(axes.direction[1]).norm(), 1, 1e-12);
}

TEST(PrincipalAxes, FaceWhatTheyAreTurnedTo) {
  EXPECT_EQ(facing({0, 0, 1}, {5, 5, -1}), Vector3d(0, 0, -1));
  EXPECT_EQ(facing({0, 0, 1}, {5, 5, 1}), Vector3d(0, 0, 1));
}

}  // namespace
}  // namespace hermite
