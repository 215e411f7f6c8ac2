#include "core/mesh/hole_fill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/evaluate/mesh_validity.h"
#include "core/output/mesh_ply.h"
#include "tests/core/mesh/expect_sound.h"
#include "tests/core/mesh/grid_mesh.h"

namespace hermite::mesh {
namespace {

using testing::HasSubstr;

TEST(HoleFill, GoesOnAsTheSurfaceAroundAndLeavesItsEndOpen) {
  const auto bowl = [](float x_m, float y_m) {
    return -2 * ((x_m - 0.1f) * (x_m - 0.1f) + (y_m - 0.1f) * (y_m - 0.1f));
  };
  const output::TriangleMesh open = grid_mesh(20, 0.01f, square_hole(6, 14), bowl);
  HoleFillStatistics counts;
  const output::TriangleMesh mesh = *holes_filled(open, {0.12, false}, {}, &counts);
  expect_sound(mesh);
  EXPECT_EQ(counts.filled, 1u);
  EXPECT_EQ(counts.left_open, 1u);
  EXPECT_EQ(evaluate::mesh_validity(mesh).border_edges, 80);
  EXPECT_NEAR(counts.filled_area_m2, 0.0064, 0.0004);
  ASSERT_GT(mesh.positions_m.size(), open.positions_m.size() + 10);
  for (std::size_t i = open.positions_m.size(); i < mesh.positions_m.size(); ++i) {
    const Eigen::Vector3f& at_m = mesh.positions_m[i];
    // Stretched flat it would be 3 mm off.
    EXPECT_NEAR(at_m.z(), bowl(at_m.x(), at_m.y()), 0.0005f);
    EXPECT_EQ(mesh.colors[i].g, 150);
  }
  ASSERT_EQ(mesh.is_filled.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    EXPECT_EQ(mesh.is_filled[i], i < open.triangles.size() ? 0 : 1);
  EXPECT_THAT(holes_filled(mesh, {0.12, false}).error().message, HasSubstr("filled already"));
}

TEST(HoleFill, WhatIsWiderOrTouchesItselfStaysOpen) {
  HoleFillStatistics counts;
  const output::TriangleMesh wide = grid_mesh(12, 0.01f, square_hole(3, 9));
  EXPECT_EQ(output::format_mesh_ply(*holes_filled(wide, {0.08, false}, {}, &counts)),
            output::format_mesh_ply(wide));
  EXPECT_EQ(counts.left_open, 2u);
  const output::TriangleMesh touching =
      grid_mesh(6, 0.01f, [](int x, int y) { return (x == 2 && y == 2) || (x == 3 && y == 3); });
  EXPECT_TRUE(holes_filled(touching, {0.1, false}, {}, &counts)->is_filled.empty());
  EXPECT_EQ(counts.not_fillable, 1u);
}

TEST(HoleFill, ClosesAllAroundAVolumeEvenWhenSheetsEnd) {
  const output::TriangleMesh sheet =
      grid_mesh(12, 0.01f, square_hole(3, 6), [](float x_m, float) { return 5 * x_m * x_m; });
  HoleFillStatistics counts;
  const output::TriangleMesh mesh = *holes_filled(sheet, {0.05, true}, {}, &counts);
  expect_sound(mesh);
  EXPECT_EQ(evaluate::mesh_validity(mesh).border_edges, 0);
  EXPECT_EQ(counts.filled, 1u);
  EXPECT_EQ(counts.closed, 1u);
  EXPECT_GT(counts.closed_area_m2, 0.01);
  EXPECT_EQ(counts.not_fillable, 0u);
  EXPECT_EQ(output::format_mesh_ply(*holes_filled(sheet, {0.05, true})),
            output::format_mesh_ply(mesh));
}

TEST(HoleFill, OneTriangleEncloseNothing) {
  const output::TriangleMesh square = grid_mesh(1, 0.01f, [](int, int) { return false; });
  output::TriangleMesh one = square;
  one.triangles.resize(1);
  remove_unused_vertices(one);
  HoleFillStatistics counts;
  EXPECT_EQ(holes_filled(one, {0.1, true}, {}, &counts)->triangles.size(), 1u);
  EXPECT_EQ(counts.not_fillable, 1u);
  EXPECT_TRUE(holes_filled({}, {0.1, true})->triangles.empty());
}

TEST(HoleFill, RefusesWithAMessageAndStops) {
  const output::TriangleMesh mesh = grid_mesh(3, 0.01f, square_hole(1, 2));
  for (const double width_m : {-0.1, 10.1, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()})
    EXPECT_THAT(holes_filled(mesh, {width_m, false}).error().message,
                HasSubstr("expected 0 to 10"));
  EXPECT_EQ(holes_filled(mesh, {0.1, false}, [](double) { return false; }).error().code,
            ErrorCode::kBusy);
  output::TriangleMesh painted = mesh;
  painted.pages.emplace_back();
  EXPECT_THAT(holes_filled(painted, {0.1, false}).error().message,
              HasSubstr("before a mesh is textured"));
  output::TriangleMesh marks = mesh;
  marks.is_filled = {1};
  EXPECT_FALSE(holes_filled(marks, {0.1, false}).ok());
}

}  // namespace
}  // namespace hermite::mesh
