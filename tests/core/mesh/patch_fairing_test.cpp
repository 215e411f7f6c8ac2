#include "core/mesh/patch_fairing.h"

#include <gtest/gtest.h>

#include "tests/core/mesh/square_patch.h"

namespace hermite::mesh::patch_fairing_test {
namespace {

Patch refined_square() {
  Patch patch = square_patch();
  refine(patch, [](std::size_t, std::size_t) { return false; });
  return patch;
}

TEST(PatchFairing, WhatIsLinearOnTheBorderIsLinearWithin) {
  const Patch patch = refined_square();
  Eigen::MatrixXd border(static_cast<Eigen::Index>(patch.border_count), 1);
  for (std::size_t i = 0; i < patch.border_count; ++i)
    border(static_cast<Eigen::Index>(i), 0) = 3 * patch.points_m[i].x() + 1;
  const Eigen::MatrixXd values = spread_from_border(patch, border);
  ASSERT_EQ(values.rows(), static_cast<Eigen::Index>(patch.points_m.size()));
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    EXPECT_NEAR(values(i, 0), 3 * patch.points_m[static_cast<std::size_t>(i)].x() + 1, 0.3);
}

// The square's surroundings: a ring, one edge wide, of a plane that rises along x.
TEST(PatchFairing, APatchGoesOnAsThePlaneAroundIt) {
  const auto on_plane = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(p.x(), p.y(), 0.5 * p.x());
  };
  Patch patch = refined_square();
  const auto inner = patch.points_m.begin() + static_cast<std::ptrdiff_t>(patch.border_count);
  for (auto point = patch.points_m.begin(); point != inner; ++point) *point = on_plane(*point);
  PatchSurroundings around;
  const auto own = static_cast<std::uint32_t>(patch.points_m.size()),
             count = static_cast<std::uint32_t>(patch.border_count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Eigen::Vector3d middle(4, 4, 0), flat(patch.points_m[i].x(), patch.points_m[i].y(), 0);
    around.points_m.push_back(on_plane(middle + 1.25 * (flat - middle)));
    const std::uint32_t next = (i + 1) % count;
    around.triangles.push_back({next, i, own + i});
    around.triangles.push_back({next, own + i, own + next});
  }
  // Wherever it was before.
  for (auto point = inner; point != patch.points_m.end(); ++point) point->z() = 7;
  ASSERT_TRUE(bend_least(patch, around));
  for (const Eigen::Vector3d& point : patch.points_m) EXPECT_NEAR(point.z(), 0.5 * point.x(), 0.1);
}

TEST(PatchFairing, WithoutInnerPointsNothingMoves) {
  Patch patch = square_patch();
  const std::vector<Eigen::Vector3d> before_m = patch.points_m;
  EXPECT_TRUE(bend_least(patch, {}));
  EXPECT_EQ(patch.points_m, before_m);
}

}  // namespace
}  // namespace hermite::mesh::patch_fairing_test
