#include "core/mesh/loop_triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace hermite::mesh {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> circle_of(std::size_t count) {
  std::vector<Vector3d> points_m;
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    points_m.emplace_back(std::cos(turn), std::sin(turn), 0);
  }
  return points_m;
}

double area_along_z_m2(const std::vector<Vector3d>& p,
                       const std::vector<output::TriangleCorners>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const double area_m2 = 0.5 * (p[b] - p[a]).cross(p[c] - p[a]).z();
    EXPECT_GT(area_m2, 0);
    sum += area_m2;
  }
  return sum;
}

TEST(LoopTriangulation, FillsAPolygonOnceWhateverItsLength) {
  for (const std::size_t count : {3u, 4u, 20u, 100u, 101u, 350u}) {
    const std::vector<Vector3d> points_m = circle_of(count), normals(count, Vector3d::UnitZ());
    const auto triangles =
        triangulated({points_m, normals, [](std::size_t, std::size_t) { return false; }});
    ASSERT_TRUE(triangles) << count;
    EXPECT_EQ(triangles->size(), count - 2);
    EXPECT_NEAR(area_along_z_m2(points_m, *triangles),
                0.5 * static_cast<double>(count) *
                    std::sin(2 * std::numbers::pi / static_cast<double>(count)),
                1e-9);
  }
}

TEST(LoopTriangulation, EdgesThatAreThereAlreadyAreNotMadeAgain) {
  const std::vector<Vector3d> points_m = circle_of(4), normals(4, Vector3d::UnitZ());
  const auto other =
      triangulated({points_m, normals, [](std::size_t i, std::size_t) { return i == 0; }});
  ASSERT_TRUE(other);
  for (const output::TriangleCorners& t : *other) {
    EXPECT_TRUE(t[0] == 1 || t[1] == 1 || t[2] == 1);
    EXPECT_TRUE(t[0] == 3 || t[1] == 3 || t[2] == 3);
  }
  EXPECT_FALSE(triangulated({points_m, normals, [](std::size_t, std::size_t) { return true; }}));
}

}  // namespace
}  // namespace hermite::mesh
