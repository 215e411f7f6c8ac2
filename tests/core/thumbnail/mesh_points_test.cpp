#include "core/thumbnail/mesh_points.h"

#include <gtest/gtest.h>

namespace hermite::thumbnail {
namespace {
namespace mesh_points_test {

// A square metre before the camera that faces it, left half and right half of another colour on its
// page.
output::TriangleMesh square() {
  output::TriangleMesh mesh;
  mesh.positions_m = {{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}};
  mesh.normals.assign(4, {0, 0, -1});
  mesh.colors.assign(4, Rgb8{10, 20, 30});
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return mesh;
}

TEST(PointsOn, AMeshLieEvenlyOnItAndFaceAsItDoes) {
  const output::Cloud cloud = points_on(square(), 800);
  EXPECT_NEAR(static_cast<double>(cloud.size()), 800, 80);
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const output::CloudPoint& point : cloud) {
    EXPECT_NEAR(point.position_m.z(), 2, 1e-5f);
    EXPECT_LT((point.normal - Eigen::Vector3f(0, 0, -1)).norm(), 1e-5f);
    EXPECT_EQ(point.color, (Rgb8{10, 20, 30}));
    EXPECT_GT(point.radius_m, 0.02f);
    mean += point.position_m / static_cast<float>(cloud.size());
  }
  EXPECT_LT((mean - Eigen::Vector3f(0.5f, 0.5f, 2)).norm(), 0.01f);
}

TEST(PointsOn, HaveTheColoursOfTheTexture) {
  output::TriangleMesh mesh = square();
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  ColorImage page(2, 1);
  page.pixels = {Rgb8{255, 0, 0}, Rgb8{0, 0, 255}};
  mesh.pages = {{page, 0, 2}};
  for (const output::CloudPoint& point : points_on(mesh, 200))
    EXPECT_EQ(point.color.r, point.position_m.x() < 0.5f ? 255 : 0);
}

TEST(PointsOn, OfTooManyTrianglesSomeAndOfThoseWithoutAnAreaNone) {
  output::TriangleMesh mesh;
  constexpr int kSide = 100;
  for (int y = 0; y <= kSide; ++y)
    for (int x = 0; x <= kSide; ++x)
      mesh.positions_m.emplace_back(0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y),
                                    1.0f);
  mesh.normals.assign(mesh.positions_m.size(), {0, 0, -1});
  mesh.colors.assign(mesh.positions_m.size(), Rgb8{1, 2, 3});
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t corner = y * (kSide + 1) + x;
      mesh.triangles.push_back({corner, corner + 1, corner + kSide + 2});
      mesh.triangles.push_back({corner, corner + kSide + 2, corner + kSide + 1});
    }
  const output::Cloud some = points_on(mesh, 500);
  EXPECT_LE(some.size(), 501u);
  EXPECT_GT(some.size(), 400u);
  mesh.triangles = {{0, 0, 1}, {3, 3, 3}};
  EXPECT_TRUE(points_on(mesh, 500).empty());
  EXPECT_TRUE(points_on({}, 500).empty());
}

}  // namespace mesh_points_test
}  // namespace
}  // namespace hermite::thumbnail
