#include "core/mesh/patch_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/core/mesh/square_patch.h"

namespace hermite::mesh {
namespace {

using Eigen::Vector3d;

TEST(PatchRefinement, CoversTheSameWithTrianglesAsSmallAsTheBordersEdges) {
  Patch patch = square_patch();
  refine(patch, [](std::size_t, std::size_t) { return false; });
  EXPECT_GT(patch.points_m.size(), patch.border_count + 20);
  EXPECT_LT(patch.points_m.size(), patch.border_count + 64);
  EXPECT_EQ(patch.triangles.size(), 2 * patch.points_m.size() - patch.border_count - 2);
  double area = 0;
  for (const auto& [a, b, c] : patch.triangles) {
    const Vector3d twice =
        (patch.points_m[b] - patch.points_m[a]).cross(patch.points_m[c] - patch.points_m[a]);
    EXPECT_GE(twice.z(), 0);
    area += 0.5 * twice.z();
  }
  EXPECT_NEAR(area, 64, 1e-9);
}

}  // namespace
}  // namespace hermite::mesh
