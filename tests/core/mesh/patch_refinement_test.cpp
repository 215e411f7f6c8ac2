#include "core/mesh/patch_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/mesh/patch_fairing.h"

namespace hermite {
namespace {

using Eigen::Vector3d;

// A square of 8 x 8 edges of 1, as a fan.
Patch square_patch() {
  Patch patch;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < 8; ++i) {
      const double along = i, full = 8;
      patch.points_m.push_back(side == 0   ? Vector3d(along, 0, 0)
                               : side == 1 ? Vector3d(full, along, 0)
                               : side == 2 ? Vector3d(full - along, full, 0)
                                           : Vector3d(0, full - along, 0));
    }
  patch.border_count = patch.points_m.size();
  for (std::uint32_t i = 1; i + 1 < patch.border_count; ++i) patch.triangles.push_back({0, i, i + 1});
  return patch;
}

TEST(PatchRefinement, CoversTheSameWithTrianglesAsSmallAsTheBordersEdges) {
  Patch patch = square_patch();
  refine(patch, [](std::size_t, std::size_t) { return false; });
  EXPECT_GT(patch.points_m.size(), patch.border_count + 20);
  EXPECT_LT(patch.points_m.size(), patch.border_count + 64);
  EXPECT_EQ(patch.triangles.size(), 2 * patch.points_m.size() - patch.border_count - 2);
  double area = 0;
  for (const auto& [a, b, c] : patch.triangles) {
    const Vector3d twice = (patch.points_m[b] - patch.points_m[a]).cross(patch.points_m[c] - patch.points_m[a]);
    EXPECT_GE(twice.z(), 0);
    area += 0.5 * twice.z();
  }
  EXPECT_NEAR(area, 64, 1e-9);
}

TEST(PatchFairing, WhatIsLinearOnTheBorderIsLinearWithin) {
  Patch patch = square_patch();
  refine(patch, [](std::size_t, std::size_t) { return false; });
  Eigen::MatrixXd border(static_cast<Eigen::Index>(patch.border_count), 1);
  for (std::size_t i = 0; i < patch.border_count; ++i) border(static_cast<Eigen::Index>(i), 0) = 3 * patch.points_m[i].x() + 1;
  const Eigen::MatrixXd values = spread_from_border(patch, border);
  ASSERT_EQ(values.rows(), static_cast<Eigen::Index>(patch.points_m.size()));
  for (Eigen::Index i = 0; i < values.rows(); ++i) EXPECT_NEAR(values(i, 0), 3 * patch.points_m[static_cast<std::size_t>(i)].x() + 1, 0.3);
}

}  // namespace
}  // namespace hermite
