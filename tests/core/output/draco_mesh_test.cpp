#include "core/output/draco_mesh.h"

#include <gtest/gtest.h>

#include <array>

namespace hermite::output {
namespace {

TEST(DracoMesh, HasTheTrianglesAndOfLongerRowsTheFirstComponents) {
  draco::Mesh mesh;
  set_triangles(mesh, 4, {{0, 1, 2}, {2, 1, 3}});
  const std::vector<std::array<std::uint16_t, 4>> rows = {
      {1, 2, 3, 9}, {4, 5, 6, 9}, {7, 8, 9, 9}, {10, 11, 12, 9}};
  const int id = add_vertex_attribute(
      mesh, {draco::GeometryAttribute::COLOR, draco::DT_UINT16, 3, true}, rows);
  EXPECT_EQ(mesh.num_points(), 4u);
  ASSERT_EQ(mesh.num_faces(), 2u);
  EXPECT_EQ(mesh.face(draco::FaceIndex(1))[2].value(), 3u);
  const draco::PointAttribute& attribute = *mesh.attribute(id);
  EXPECT_TRUE(attribute.normalized());
  ASSERT_EQ(attribute.num_components(), 3);
  std::array<std::uint16_t, 3> value{};
  ASSERT_TRUE((attribute.ConvertValue<std::uint16_t, 3>(
      attribute.mapped_index(draco::PointIndex(3)), value.data())));
  EXPECT_EQ(value, (std::array<std::uint16_t, 3>{10, 11, 12}));
}

}  // namespace
}  // namespace hermite::output
