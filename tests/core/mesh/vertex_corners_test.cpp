#include "core/mesh/vertex_corners.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::mesh {
namespace {

using testing::ElementsAre;

TEST(VertexCorners, AreFoundByVertexInAscendingOrder) {
  output::TriangleMesh mesh;
  mesh.positions_m.resize(5);
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}, {3, 0, 2}};
  const VertexCorners corners(mesh);
  EXPECT_THAT(corners.at(0), ElementsAre(0, 7));
  EXPECT_THAT(corners.at(1), ElementsAre(1, 4));
  EXPECT_THAT(corners.at(2), ElementsAre(2, 3, 8));
  EXPECT_THAT(corners.at(3), ElementsAre(5, 6));
  EXPECT_TRUE(corners.at(4).empty());
  EXPECT_EQ(vertex_at(mesh, 8), 2u);
}

TEST(VertexCorners, TheCornersOfATriangleFollowEachOther) {
  for (std::uint32_t corner = 3; corner < 6; ++corner) {
    EXPECT_EQ(next_corner(previous_corner(corner)), corner);
    EXPECT_EQ(next_corner(next_corner(corner)), previous_corner(corner));
    EXPECT_EQ(next_corner(corner) / 3, 1u);
  }
}

}  // namespace
}  // namespace hermite::mesh
