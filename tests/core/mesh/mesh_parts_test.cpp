#include "core/mesh/mesh_parts.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace hermite::mesh {
namespace {

output::TriangleMesh mesh_of_triangles(std::vector<Eigen::Vector3f> positions_m,
                                       std::vector<output::TriangleCorners> triangles) {
  output::TriangleMesh mesh;
  mesh.normals.assign(positions_m.size(), Eigen::Vector3f::UnitZ());
  mesh.colors.assign(positions_m.size(), Rgb8{1, 2, 3});
  mesh.positions_m = std::move(positions_m);
  mesh.triangles = std::move(triangles);
  return mesh;
}

TEST(MeshParts, SmallOnesGoAndVerticesFollow) {
  output::TriangleMesh mesh = mesh_of_triangles(
      {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {5, 0, 0}, {9, 0, 0}, {5, 4, 0}, {7, 7, 7}},
      {{0, 1, 2}, {3, 4, 5}});
  mesh.confidence_eighths = {10, 11, 12, 13, 14, 15, 16};
  EXPECT_EQ(remove_small_parts(mesh, 0.01), 1u);
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0], (output::TriangleCorners{0, 1, 2}));
  ASSERT_EQ(mesh.positions_m.size(), 3u);
  EXPECT_EQ(mesh.positions_m[1], Eigen::Vector3f(9, 0, 0));
  EXPECT_EQ(mesh.colors.size(), 3u);
  EXPECT_EQ(mesh.confidence_eighths, (std::vector<std::uint8_t>{13, 14, 15}));
  EXPECT_EQ(remove_small_parts(mesh, 0), 0u);
}

TEST(MeshParts, FansThatTouchInAPointAreSplit) {
  output::TriangleMesh mesh = mesh_of_triangles(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  EXPECT_EQ(split_touching_fans(mesh), 1u);
  EXPECT_EQ(mesh.positions_m.size(), 6u);
  EXPECT_EQ(mesh.positions_m[5], mesh.positions_m[0]);
  EXPECT_EQ(mesh.triangles[1][0], 5u);
  EXPECT_EQ(split_touching_fans(mesh), 0u);
}

TEST(MeshParts, AnEdgeOfFourTrianglesIsOpened) {
  output::TriangleMesh mesh =
      mesh_of_triangles({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}},
                        {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}});
  EXPECT_EQ(split_touching_fans(mesh), 6u);
  EXPECT_EQ(mesh.positions_m.size(), 12u);
}

TEST(MeshParts, AQuadStaysWhole) {
  output::TriangleMesh mesh =
      mesh_of_triangles({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  EXPECT_EQ(split_touching_fans(mesh), 0u);
}

// The middle of a net of five by five lies beyond its neighbour.
TEST(MeshParts, AFoldIsLaidFlat) {
  std::vector<Eigen::Vector3f> positions_m;
  for (int i = 0; i < 25; ++i)
    positions_m.push_back({static_cast<float>(i % 5), static_cast<float>(i / 5), 0});
  positions_m[12].x() += 1.4f;
  std::vector<output::TriangleCorners> triangles;
  for (std::uint32_t i = 0; i < 19; ++i)
    if (i % 5 != 4) triangles.insert(triangles.end(), {{i, i + 1, i + 6}, {i, i + 6, i + 5}});
  output::TriangleMesh mesh = mesh_of_triangles(positions_m, triangles);
  EXPECT_EQ(unfold(mesh), 0u);
  ASSERT_EQ(mesh.triangles.size(), 32u);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f across = (mesh.positions_m[b] - mesh.positions_m[a])
                                       .cross(mesh.positions_m[c] - mesh.positions_m[a]);
    EXPECT_GT(across.z(), 0);
  }
  EXPECT_EQ(mesh.positions_m[0], positions_m[0]) << "what is flat stays";
}

TEST(MeshParts, WhatStaysFoldedGoes) {
  // Seen from below.
  output::TriangleMesh mesh = mesh_of_triangles({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}, {{0, 1, 2}});
  EXPECT_EQ(unfold(mesh), 1u);
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST(MeshParts, NothingHasNoParts) {
  output::TriangleMesh mesh;
  EXPECT_EQ(remove_small_parts(mesh, 1), 0u);
  EXPECT_EQ(split_touching_fans(mesh), 0u);
  EXPECT_EQ(unfold(mesh), 0u);
}

}  // namespace
}  // namespace hermite::mesh
