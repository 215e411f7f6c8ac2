#include "core/mesh/simplify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/evaluate/mesh_validity.h"
#include "core/mesh/contour.h"
#include "core/output/mesh_ply.h"
#include "tests/core/mesh/expect_sound.h"
#include "tests/core/mesh/mesh_shapes.h"

namespace hermite::mesh {
namespace {

using testing::HasSubstr;

output::TriangleMesh fine_mesh_of(const output::Cloud& cloud) {
  ContourOptions options;
  options.field.cell_m = 0.01;
  return *contour(cloud, options);
}

TEST(Simplify, AFlatSquareNeedsFewTrianglesAndKeepsItsBorder) {
  output::Cloud cloud;
  append_square(cloud, 0.4f, 0.01f, 0.0031f);
  const output::TriangleMesh fine = fine_mesh_of(cloud), coarse = *simplified(fine, {});
  EXPECT_LT(20 * coarse.triangles.size(), fine.triangles.size());
  EXPECT_NEAR(evaluate::mesh_validity(coarse).area_m2, evaluate::mesh_validity(fine).area_m2,
              0.002);
}

TEST(Simplify, StaysNearACurvedSurfaceAndSound) {
  const float radius_m = 0.2f;
  const output::TriangleMesh fine = fine_mesh_of(sphere(radius_m, 5000)),
                             coarse = *simplified(fine, {0.002, 0});
  EXPECT_LT(4 * coarse.triangles.size(), fine.triangles.size());
  expect_sound(coarse);
  const evaluate::MeshValidity validity = evaluate::mesh_validity(coarse);
  EXPECT_EQ(validity.border_edges, 0);
  EXPECT_EQ(validity.components, 1);
  for (const auto& [a, b, c] : coarse.triangles) {
    const Eigen::Vector3f middle_m =
        (coarse.positions_m[a] + coarse.positions_m[b] + coarse.positions_m[c]) / 3;
    ASSERT_NEAR(middle_m.norm(), radius_m, 0.006f);
  }
}

TEST(Simplify, StopsAtACount) {
  const output::TriangleMesh fine = fine_mesh_of(sphere(0.2f, 5000));
  const auto triangles = static_cast<std::int64_t>(fine.triangles.size() / 2);
  const output::TriangleMesh half = *simplified(fine, {1, triangles});
  EXPECT_NEAR(static_cast<double>(half.triangles.size()), static_cast<double>(triangles), 10);
  EXPECT_EQ(output::format_mesh_ply(*simplified(fine, {1, triangles})),
            output::format_mesh_ply(half));
}

TEST(Simplify, PassesShareTheErrorAndCanBeStoppedBetween) {
  const float radius_m = 0.2f;
  const output::TriangleMesh fine = fine_mesh_of(sphere(radius_m, 5000));
  const SimplifyOptions options{0.002, 0, 2000};
  ASSERT_GT(fine.triangles.size(), 8000u);
  std::vector<double> told;
  const output::TriangleMesh coarse = *simplified(fine, options, [&](double done) {
    told.push_back(done);
    return true;
  });
  EXPECT_GE(told.size(), 3u);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_LT(told.back(), 1);
  EXPECT_LT(4 * coarse.triangles.size(), fine.triangles.size());
  expect_sound(coarse);
  EXPECT_EQ(evaluate::mesh_validity(coarse).border_edges, 0);
  for (const auto& [a, b, c] : coarse.triangles) {
    const Eigen::Vector3f middle_m =
        (coarse.positions_m[a] + coarse.positions_m[b] + coarse.positions_m[c]) / 3;
    ASSERT_NEAR(middle_m.norm(), radius_m, 0.006f);
  }
  for (const std::size_t asked : {1u, 2u}) {
    std::size_t count = 0;
    const auto stopped = simplified(fine, options, [&](double) { return ++count < asked; });
    EXPECT_EQ(stopped.error().code, ErrorCode::kBusy);
    EXPECT_EQ(count, asked) << "stops at once";
  }
}

TEST(Simplify, RefusesWithAMessage) {
  const output::TriangleMesh none;
  EXPECT_TRUE(simplified(none, {})->triangles.empty());
  EXPECT_THAT(simplified(none, {0, 0}).error().message, HasSubstr("error of"));
  EXPECT_THAT(simplified(none, {0.001, 0, 1}).error().message, HasSubstr("last pass"));
  EXPECT_THAT(simplified(none, {0.001, -1}).error().message, HasSubstr("triangles"));
  output::TriangleMesh painted = fine_mesh_of(sphere(0.1f, 1500));
  painted.pages.emplace_back();
  EXPECT_THAT(simplified(painted, {}).error().message, HasSubstr("before it is textured"));
  output::TriangleMesh broken;
  broken.triangles.push_back({0, 1, 2});
  EXPECT_FALSE(simplified(broken, {}).ok());
}

}  // namespace
}  // namespace hermite::mesh
