#include "core/output/mesh_ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/output/ply_reader.h"
#include "tests/support/analytic_mesh.h"

namespace hermite::output {
namespace {

using ::testing::HasSubstr;

TEST(MeshPly, ReadsBackAsTheSameMesh) {
  const TriangleMesh mesh = test::sphere_mesh(5, 7);
  const std::string bytes = format_mesh_ply(mesh);
  const Result<PlyShape> shape = parse_ply(bytes);
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  EXPECT_EQ(shape->positions, mesh.positions_m);
  EXPECT_EQ(shape->normals, mesh.normals);
  EXPECT_EQ(shape->triangles, mesh.triangles);
  EXPECT_EQ(bytes.size(), bytes.find("end_header\n") + 11 + 27 * mesh.positions_m.size() +
                              13 * mesh.triangles.size());
}

TEST(MeshPly, HeaderNamesThePropertiesInOrder) {
  EXPECT_THAT(format_mesh_ply(test::sphere_mesh(2, 3)),
              HasSubstr("element vertex 9\nproperty float x\nproperty float y\nproperty float z\n"
                        "property float nx\nproperty float ny\nproperty float nz\n"
                        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                        "element face 6\nproperty list uchar int vertex_indices\nend_header\n"));
}

TEST(MeshPly, MarksOfWhatIsFilledReadBack) {
  TriangleMesh mesh = test::sphere_mesh(2, 3);
  mesh.is_filled = {0, 1, 0, 0, 1, 1};
  const Result<PlyShape> shape = parse_ply(format_mesh_ply(mesh));
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  EXPECT_EQ(shape->is_filled, mesh.is_filled);
  EXPECT_EQ(shape->triangles, mesh.triangles);
}

TEST(MeshPly, AnEmptyMeshIsAFileToo) {
  const std::string bytes = format_mesh_ply({});
  EXPECT_TRUE(bytes.ends_with("end_header\n"));
  EXPECT_TRUE(parse_ply(bytes).ok());
}

TEST(MeshPly, TestMeshesLookOutwards) {
  const TriangleMesh sphere = test::sphere_mesh(6, 9), plane = test::textured_plane(4, 2, 3);
  for (const TriangleMesh* mesh : {&sphere, &plane})
    for (const TriangleCorners& corners : mesh->triangles)
      EXPECT_GT(test::face_normal(*mesh, corners)
                    .dot(mesh->normals[corners[0]] + mesh->normals[corners[1]] +
                         mesh->normals[corners[2]]),
                0);
}

}  // namespace
}  // namespace hermite::output
