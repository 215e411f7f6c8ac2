#include "core/mesh/quad_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace hermite::mesh {
namespace {

CubeVertex vertex(int x, float z_m, const Eigen::Vector3f& normal = Eigen::Vector3f::UnitZ()) {
  CubeVertex made;
  made.key = vertex_key({x, 0, 0}, 0);
  made.position_m = {static_cast<float>(x % 2), static_cast<float>(x / 2), z_m};
  made.normal = normal;
  return made;
}

// The corners of a square in the order of their keys; round it they are 0, 1, 3, 2.
CubeSurface bent_square(float z_of_0_m, float z_of_1_m) {
  CubeSurface surface;
  surface.vertices = {vertex(0, z_of_0_m), vertex(1, z_of_1_m), vertex(2, 0), vertex(3, 0)};
  surface.quads = {{vertex_key({0, 0, 0}, 0), vertex_key({1, 0, 0}, 0), vertex_key({3, 0, 0}, 0),
                    vertex_key({2, 0, 0}, 0)}};
  return surface;
}

bool has_edge(const output::TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  int faces = 0;
  for (const output::TriangleCorners& triangle : mesh.triangles)
    faces += std::count(triangle.begin(), triangle.end(), a) +
                         std::count(triangle.begin(), triangle.end(), b) ==
                     2
                 ? 1
                 : 0;
  return faces == 2;
}

TEST(QuadMesh, TakesTheDiagonalThatGoesWithTheNormals) {
  CubeSurface surface = bent_square(0.5f, 0);
  surface.vertices[1].normal = surface.vertices[2].normal = surface.vertices[3].normal =
      Eigen::Vector3f::UnitZ();
  surface.vertices[0].is_smooth = false;  // a corner sticks out: only its own triangle is bent
  const output::TriangleMesh mesh = mesh_of(surface);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_TRUE(has_edge(mesh, 1, 2) || has_edge(mesh, 0, 3));
  EXPECT_EQ(mesh.positions_m.size(), 4u);
}

TEST(QuadMesh, TakesTheShorterDiagonalWhereNormalsDoNotTell) {
  CubeSurface surface = bent_square(0, 0);
  surface.vertices[3].position_m = {3, 3, 0};  // 0 to 3 is long, 1 to 2 short
  EXPECT_TRUE(has_edge(mesh_of(surface), 1, 2));
  surface.vertices[3].position_m = {0.6f, 0.6f, 0};
  EXPECT_TRUE(has_edge(mesh_of(surface), 0, 3));
}

TEST(QuadMesh, LeavesOutWhatIsNotSupported) {
  CubeSurface surface = bent_square(0, 0);
  surface.vertices[2].is_supported = false;
  const output::TriangleMesh mesh = mesh_of(surface);
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_TRUE(mesh.positions_m.empty()) << "vertices of no triangle, too";
}

TEST(QuadMeshDeathTest, AQuadOfNoVertexIsAMistake) {
  CubeSurface surface = bent_square(0, 0);
  surface.vertices.pop_back();
  EXPECT_DEATH(mesh_of(surface), "differ about what lies between");
}

}  // namespace
}  // namespace hermite::mesh
