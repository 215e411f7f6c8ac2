#include "core/mesh/border_loops.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/core/mesh/grid_mesh.h"

namespace hermite::mesh {
namespace {

Borders borders_of_mesh(const output::TriangleMesh& mesh) {
  return borders_of(mesh, VertexCorners(mesh));
}

TEST(BorderLoops, AHoleIsToldFromWhereTheSurfaceEnds) {
  const output::TriangleMesh mesh = grid_mesh(6, 0.01f, square_hole(2, 4));
  const Borders borders = borders_of_mesh(mesh);
  ASSERT_EQ(borders.loops.size(), 2u);
  EXPECT_EQ(borders.tangled, 0u);
  EXPECT_EQ(borders.loops[0].vertices.size(), 24u);
  EXPECT_FALSE(is_hole(mesh, borders.loops[0]));
  EXPECT_EQ(borders.loops[1].vertices.size(), 8u);
  EXPECT_TRUE(is_hole(mesh, borders.loops[1]));
  EXPECT_FALSE(is_wider(mesh, borders.loops[1], 0.0283));
  EXPECT_TRUE(is_wider(mesh, borders.loops[1], 0.0282));
}

TEST(BorderLoops, TheEndOfATubeIsNoHole) {
  output::TriangleMesh tube;
  constexpr std::uint32_t kCount = 12;
  for (std::uint32_t i = 0; i < 2 * kCount; ++i) {
    const float turn = static_cast<float>(2 * std::numbers::pi) * static_cast<float>(i % kCount) /
                       static_cast<float>(kCount);
    tube.positions_m.emplace_back(std::cos(turn), std::sin(turn), i < kCount ? 0.0f : 1.0f);
    tube.normals.emplace_back(std::cos(turn), std::sin(turn), 0.0f);
    tube.colors.push_back({});
  }
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const std::uint32_t next = (i + 1) % kCount;
    tube.triangles.push_back({i, next, kCount + next});
    tube.triangles.push_back({i, kCount + next, kCount + i});
  }
  const Borders borders = borders_of_mesh(tube);
  ASSERT_EQ(borders.loops.size(), 2u);
  for (const BorderLoop& loop : borders.loops) EXPECT_FALSE(is_hole(tube, loop));
}

TEST(BorderLoops, WhatTouchesItselfOrDisagreesIsNoLoop) {
  const Borders touching = borders_of_mesh(
      grid_mesh(6, 0.01f, [](int x, int y) { return (x == 2 && y == 2) || (x == 3 && y == 3); }));
  EXPECT_EQ(touching.loops.size(), 1u);
  EXPECT_EQ(touching.tangled, 1u);

  // A strip of five squares, turned once: its triangles cannot agree which side is outside.
  output::TriangleMesh moebius;
  for (std::uint32_t i = 0; i < 5; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * i + 1, c = i == 4 ? 1 : a + 2, d = i == 4 ? 0 : b + 2;
    moebius.triangles.push_back({a, b, d});
    moebius.triangles.push_back({a, d, c});
    for (int k = 0; k < 2; ++k) {
      const auto turn = static_cast<float>(i);
      moebius.positions_m.emplace_back(std::cos(turn), std::sin(turn), static_cast<float>(k));
      moebius.normals.emplace_back(Eigen::Vector3f::UnitZ());
      moebius.colors.push_back({});
    }
  }
  const Borders borders = borders_of_mesh(moebius);
  EXPECT_TRUE(borders.loops.empty());
  EXPECT_EQ(borders.tangled, 1u);

  EXPECT_TRUE(borders_of_mesh({}).loops.empty());
}

}  // namespace
}  // namespace hermite::mesh
