#include "core/output/mesh_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/analytic_mesh.h"

namespace hermite::output {
namespace {

using ::testing::HasSubstr;

// What is said of a textured plane of two pages that was changed.
std::string message_about(const std::function<void(TriangleMesh&)>& change) {
  TriangleMesh mesh = test::textured_plane(4, 2, 3);
  change(mesh);
  const Status status = check_mesh(mesh);
  return status.ok() ? "well" : status.error().message;
}

TEST(MeshCheck, TakesWhatIsWhole) {
  EXPECT_TRUE(check_mesh_with_triangles(test::sphere_mesh(4, 5)).ok());
  EXPECT_TRUE(check_mesh_with_triangles(test::textured_plane(4, 2, 1)).ok());
  EXPECT_TRUE(check_mesh({}).ok());
}

TEST(MeshCheck, NamesWhatIsWrong) {
  EXPECT_EQ(message_about([](TriangleMesh&) {}), "well");
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.normals.pop_back(); }),
              HasSubstr("15 normals"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.colors.clear(); }),
              HasSubstr("0 colours"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.texture_coordinates.pop_back(); }),
              HasSubstr("15 texture coordinates"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.pages.clear(); }), HasSubstr("0 pages"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.positions_m[3].y() = std::nanf(""); }),
              HasSubstr("position of vertex 3"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.normals[4].x() = INFINITY; }),
              HasSubstr("normal of vertex 4"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.texture_coordinates[5].x() = INFINITY; }),
              HasSubstr("coordinate of vertex 5"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.triangles[2][1] = 16; }),
              HasSubstr("triangle 2 refers to vertex 16 of 16"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.pages[1].first_triangle = 5; }),
              HasSubstr("page 1 starts at triangle 5"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.pages[1].triangle_count = 3; }),
              HasSubstr("7 of 8 triangles"));
  EXPECT_THAT(message_about([](TriangleMesh& mesh) { mesh.pages[0].image = {}; }),
              HasSubstr("page 0 has no image"));
}

TEST(MeshCheck, AMeshWithoutATriangleIsOneOnlyWhereThatCanBeSaid) {
  TriangleMesh mesh = test::sphere_mesh(4, 5);
  mesh.triangles.clear();
  EXPECT_TRUE(check_mesh(mesh).ok());
  const Status status = check_mesh_with_triangles(mesh);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.error().message, HasSubstr("no triangle"));
}

}  // namespace
}  // namespace hermite::output
