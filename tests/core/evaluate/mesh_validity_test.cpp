#include "core/evaluate/mesh_validity.h"

#include <gtest/gtest.h>

#include <limits>

namespace hermite::evaluate {
namespace {

using Eigen::Vector3f;

// A cube of 1 m with outward faces and normals away from its middle.
output::TriangleMesh cube_to_judge() {
  output::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions_m.emplace_back(i & 1, i >> 1 & 1, i >> 2);
    mesh.normals.push_back((mesh.positions_m.back() - Vector3f::Constant(0.5f)).normalized());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TEST(MeshValidity, OfACubeIsSound) {
  const MeshValidity validity = mesh_validity(cube_to_judge());
  EXPECT_EQ(validity.vertices, 8);
  EXPECT_EQ(validity.triangles, 12);
  for (const std::int64_t fault :
       {validity.not_finite_vertices, validity.wrong_indices, validity.degenerate_faces,
        validity.repeated_faces, validity.overfull_edges, validity.border_edges,
        validity.disagreeing_edges, validity.flipped_faces, validity.pinched_vertices,
        validity.loose_vertices})
    EXPECT_EQ(fault, 0);
  EXPECT_EQ(validity.components, 1);
  EXPECT_EQ(validity.largest_component, 1);
  EXPECT_NEAR(validity.area_m2, 6, 1e-6);
}

TEST(MeshValidity, AFlippedFaceDisagreesAlongItsThreeEdges) {
  output::TriangleMesh mesh = cube_to_judge();
  std::swap(mesh.triangles[4][0], mesh.triangles[4][1]);
  const MeshValidity validity = mesh_validity(mesh);
  EXPECT_EQ(validity.flipped_faces, 1);
  EXPECT_EQ(validity.disagreeing_edges, 3);
  EXPECT_EQ(validity.overfull_edges, 0);
}

TEST(MeshValidity, WithoutNormalsNoFaceIsFlipped) {
  output::TriangleMesh mesh = cube_to_judge();
  mesh.normals.clear();
  for (output::TriangleCorners& corners : mesh.triangles) std::swap(corners[0], corners[1]);
  EXPECT_EQ(mesh_validity(mesh).flipped_faces, 0);
}

TEST(MeshValidity, AFinOnAnEdgeMakesItOverfull) {
  output::TriangleMesh mesh = cube_to_judge();
  mesh.positions_m.emplace_back(2, 0, 0);
  mesh.normals.push_back(Vector3f::UnitZ());
  mesh.triangles.push_back({0, 1, 8});
  const MeshValidity validity = mesh_validity(mesh);
  EXPECT_EQ(validity.overfull_edges, 1);
  EXPECT_EQ(validity.border_edges, 2);
  EXPECT_EQ(validity.components, 1);
}

TEST(MeshValidity, TwoCubesThatShareACornerArePinchedThereAndOnePart) {
  output::TriangleMesh mesh = cube_to_judge();
  const output::TriangleMesh other = cube_to_judge();
  for (int i = 0; i < 7; ++i) {  // its corner 7 is corner 0 of the first
    mesh.positions_m.push_back(other.positions_m[static_cast<std::size_t>(i)] - Vector3f::Ones());
    mesh.normals.push_back(other.normals[static_cast<std::size_t>(i)]);
  }
  for (output::TriangleCorners corners : other.triangles) {
    for (std::uint32_t& corner : corners) corner = corner == 7 ? 0 : corner + 8;
    mesh.triangles.push_back(corners);
  }
  MeshValidity validity = mesh_validity(mesh);
  EXPECT_EQ(validity.pinched_vertices, 1);
  EXPECT_EQ(validity.components, 1);
  EXPECT_EQ(validity.border_edges, 0);

  mesh.positions_m.push_back(Vector3f::Zero());
  mesh.normals.push_back(Vector3f::UnitZ());
  for (std::size_t i = 12; i < mesh.triangles.size(); ++i)
    for (std::uint32_t& corner : mesh.triangles[i]) corner = corner == 0 ? 15 : corner;
  mesh.triangles.pop_back();
  validity = mesh_validity(mesh);
  EXPECT_EQ(validity.pinched_vertices, 0);
  EXPECT_EQ(validity.components, 2);
  EXPECT_EQ(validity.border_edges, 3);
  EXPECT_NEAR(validity.largest_component, 12.0 / 23, 1e-9);
}

TEST(MeshValidity, DamageIsCountedAndBreaksNothing) {
  output::TriangleMesh mesh = cube_to_judge();
  mesh.positions_m[0].x() = std::numeric_limits<float>::quiet_NaN();
  mesh.triangles.push_back({1, 2, 99});
  mesh.triangles.push_back({3, 3, 7});
  mesh.triangles.push_back({7, 5, 3});
  mesh.positions_m.emplace_back(5, 5, 5);
  mesh.normals.push_back(Vector3f::UnitZ());
  const MeshValidity validity = mesh_validity(mesh);
  EXPECT_EQ(validity.not_finite_vertices, 1);
  EXPECT_EQ(validity.wrong_indices, 1);
  EXPECT_EQ(validity.degenerate_faces, 1 + 3)
      << "the one with equal corners, and those at the vertex that is no number";
  EXPECT_EQ(validity.repeated_faces, 1);
  EXPECT_EQ(validity.overfull_edges, 3);
  EXPECT_EQ(validity.loose_vertices, 1);

  const MeshValidity empty = mesh_validity(output::TriangleMesh());
  EXPECT_EQ(empty.triangles, 0);
  EXPECT_EQ(empty.components, 0);
  EXPECT_EQ(empty.largest_component, 0);
}

TEST(MeshValidity, VerticesAwayAreThoseWithoutAPointNearby) {
  output::TriangleMesh mesh = cube_to_judge();
  mesh.positions_m[7] = Vector3f::Constant(std::numeric_limits<float>::infinity());
  const std::vector<Vector3f> points{{0, 0, 0.015f}, {1, 0, 0.025f}, {0, 1.0f, -0.019f}};
  EXPECT_EQ(vertices_away_from(points, mesh, 0.02), 8 - 2);
  EXPECT_EQ(vertices_away_from({}, mesh, 0.02), 8);
}

}  // namespace
}  // namespace hermite::evaluate
