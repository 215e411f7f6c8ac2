#include "core/evaluate/triangle_surface.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace hermite::evaluate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Triangle kUnit{Vector3f(0, 0, 0), Vector3f(1, 0, 0), Vector3f(0, 1, 0)};

TEST(DistanceToTriangle, OfEveryRegion) {
  EXPECT_NEAR(distance_to_triangle_m({0.2f, 0.3f, -0.5f}, kUnit), 0.5, 1e-6) << "its inside";
  EXPECT_NEAR(distance_to_triangle_m({-3, -4, 0}, kUnit), 5, 1e-6) << "corner a";
  EXPECT_NEAR(distance_to_triangle_m({3, 0, 0}, kUnit), 2, 1e-6) << "corner b";
  EXPECT_NEAR(distance_to_triangle_m({0, 4, 4}, kUnit), 5, 1e-6) << "corner c";
  EXPECT_NEAR(distance_to_triangle_m({0.5f, -2, 0}, kUnit), 2, 1e-6) << "edge ab";
  EXPECT_NEAR(distance_to_triangle_m({-2, 0.5f, 0}, kUnit), 2, 1e-6) << "edge ac";
  EXPECT_NEAR(distance_to_triangle_m({1, 1, 0}, kUnit), std::sqrt(0.5), 1e-6) << "edge bc";
  EXPECT_NEAR(
      distance_to_triangle_m({1, 2, 2}, {Vector3f(0, 0, 0), Vector3f(0, 0, 0), Vector3f(0, 0, 0)}),
      3, 1e-6)
      << "a point";
}

TEST(TriangleSurface, AgreesWithAskingEveryTriangle) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-0.5f, 0.5f), size(-0.2f, 0.2f);
  std::vector<Triangle> triangles;
  for (int i = 0; i < 60; ++i) {
    const Vector3f a(place(random), place(random), place(random));
    triangles.push_back({a, a + Vector3f(size(random), size(random), size(random)),
                         a + Vector3f(size(random), size(random), size(random))});
  }
  const double reach_m = 0.15;
  const TriangleSurface surface(triangles, reach_m);
  int far_count = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3f point(place(random), place(random), place(random));
    double expected = reach_m;
    for (const Triangle& triangle : triangles)
      expected = std::min(expected, distance_to_triangle_m(point, triangle));
    ASSERT_NEAR(surface.distance_m(point.cast<double>()), expected, 1e-6);
    far_count += expected == reach_m ? 1 : 0;
  }
  EXPECT_GT(far_count, 20);
  EXPECT_LT(far_count, 1800);
}

TEST(TriangleSurface, AWallOfTwoTrianglesIsAWall) {
  const Vector3f a(-3, -2, 1), b(3, -2, 1), c(3, 2, 1), d(-3, 2, 1);
  const TriangleSurface wall({{a, b, c}, {a, c, d}}, 0.2);
  EXPECT_NEAR(wall.distance_m({2.9, -1.7, 1.013}), 0.013, 1e-6);
  EXPECT_NEAR(wall.distance_m({3.05, 0, 1}), 0.05, 1e-6);
  EXPECT_EQ(wall.distance_m({0, 0, 2}), 0.2) << "out of reach";
}

TEST(TriangleSurface, BrokenTrianglesAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const TriangleSurface surface({{Vector3f(nan, 0, 0), Vector3f(1, 0, 0), Vector3f(0, 1, 0)}}, 0.1);
  EXPECT_TRUE(surface.empty());
  EXPECT_EQ(surface.distance_m({0, 0, 0}), 0.1);
}

TEST(DepthTriangles, CoverWhatTheCameraSeesAndStopAtEdges) {
  const Camera camera{64, 64, 60, 60, 31.5, 31.5, 1000};
  DepthImage depth(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) depth.at(x, y) = x < 32 ? 1000 : 2000;
  depth.at(10, 10) = 0;
  const Rigid3 world_from_camera{Eigen::Quaterniond::Identity(), {0, 0, 5}};
  std::vector<Triangle> triangles;
  append_depth_triangles(depth, camera, world_from_camera, 1, triangles);
  // 63 x 63 squares of two, less the column across the edge, less the six around the hole.
  EXPECT_EQ(triangles.size(), 2u * 63 * 62 - 6);
  const TriangleSurface surface(triangles, 0.3);
  EXPECT_NEAR(surface.distance_m(world_from_camera * camera.unproject(20.3, 40.6, 1.004)), 0.004,
              1e-5);
  EXPECT_GT(surface.distance_m(world_from_camera * camera.unproject(31.5, 32, 1.5)), 0.29)
      << "nothing spans the edge";
}

}  // namespace
}  // namespace hermite::evaluate
