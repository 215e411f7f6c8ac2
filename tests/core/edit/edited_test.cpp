#include "core/edit/edited.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/output/mesh_check.h"
#include "tests/core/mesh/expect_sound.h"
#include "tests/core/mesh/grid_mesh.h"
#include "tests/core/mesh/mesh_shapes.h"

namespace hermite::edit {
namespace {

using Eigen::Vector3d;

constexpr int kSide = 40;
constexpr float kCell_m = 0.025f;  // a square metre

output::TriangleMesh wavy_sheet() {
  const auto height_m = [](float x_m, float y_m) { return 0.05f * std::sin(9 * x_m + 5 * y_m); };
  return mesh::grid_mesh(
      kSide, kCell_m, [](int, int) { return false; }, height_m);
}

double total_m2(const output::TriangleMesh& mesh) {
  double sum_m2 = 0;
  for (const output::TriangleCorners& triangle : mesh.triangles)
    sum_m2 += mesh::area_m2(mesh, triangle);
  return sum_m2;
}

// Its edges are turned about z.
EditBox box_of(double turn_rad, const Vector3d& low_m, const Vector3d& high_m) {
  EditBox box;
  box.axes << std::cos(turn_rad), std::sin(turn_rad), 0, -std::sin(turn_rad), std::cos(turn_rad), 0,
      0, 0, 1;
  box.low_m = low_m;
  box.high_m = high_m;
  return box;
}

TEST(Edited, WhatIsKeptAndWhatIsRemovedAreTheWholeSurface) {
  const output::TriangleMesh sheet = wavy_sheet();
  const EditBox box = box_of(0.4, {0.31, -0.1, -0.02}, {0.83, 0.4, 0.033});
  const output::TriangleMesh inside =
      edited(sheet, std::vector<ScanEdit>{{EditKind::kKeepInside, box, 0}});
  const output::TriangleMesh outside =
      edited(sheet, std::vector<ScanEdit>{{EditKind::kRemoveInside, box, 0}});
  EXPECT_NEAR(total_m2(inside) + total_m2(outside), total_m2(sheet), 1e-5);
  EXPECT_GT(total_m2(inside), 0.05);
  for (const output::TriangleMesh& part : {inside, outside}) {
    EXPECT_TRUE(output::check_mesh(part).ok());
    mesh::expect_sound(part);
  }
  // The cut is straight: corners reach the faces, and none is beyond.
  Vector3d low_m = Vector3d::Constant(9), high_m = -low_m;
  for (const Eigen::Vector3f& position_m : inside.positions_m) {
    low_m = low_m.cwiseMin(box.axes * position_m.cast<double>());
    high_m = high_m.cwiseMax(box.axes * position_m.cast<double>());
  }
  EXPECT_TRUE((low_m.array() >= box.low_m.array() - 1.01e-4).all()) << low_m.transpose();
  EXPECT_TRUE((high_m.array() <= box.high_m.array() + 1.01e-4).all()) << high_m.transpose();
  EXPECT_NEAR(high_m.x(), box.high_m.x(), 1.01e-4);
  EXPECT_NEAR(low_m.z(), box.low_m.z(), 1.01e-4);
}

TEST(Edited, ACutThroughVerticesAndAlongEdgesLeavesNoSlivers) {
  const output::TriangleMesh sheet = mesh::grid_mesh(8, 0.125f, [](int, int) { return false; });
  const output::TriangleMesh half = edited(
      sheet,
      std::vector<ScanEdit>{{EditKind::kKeepInside, box_of(0, {-1, -1, -1}, {0.5, 2, 1}), 0}});
  EXPECT_EQ(half.triangles.size(), sheet.triangles.size() / 2);
  EXPECT_EQ(half.positions_m.size(), 5u * 9u);
  const output::TriangleMesh diagonal =
      edited(sheet, std::vector<ScanEdit>{
                        {EditKind::kRemoveInside, box_of(M_PI / 4, {-3, 0, -1}, {3, 3, 1}), 0}});
  EXPECT_EQ(diagonal.triangles.size(), sheet.triangles.size() / 2);
  mesh::expect_sound(diagonal);
}

TEST(Edited, NothingIsLeftOutsideOfEverything) {
  const std::vector<ScanEdit> edits{{EditKind::kKeepInside, box_of(0, {5, 5, 5}, {6, 6, 6}), 0},
                                    {EditKind::kRemoveFloating, {}, 1},
                                    {EditKind::kRemoveInside, box_of(0, {0, 0, 0}, {1, 1, 1}), 0}};
  const output::TriangleMesh none = edited(wavy_sheet(), edits);
  EXPECT_TRUE(none.triangles.empty() && none.positions_m.empty() && none.normals.empty() &&
              none.colors.empty());
  EXPECT_TRUE(edited(mesh::cube(0.4f, 0.02f), edits).empty());
}

// Two pages; marks on some triangles; coordinates that follow from the position.
TEST(Edited, TexturesAndMarksStayWithTheirTriangles) {
  output::TriangleMesh sheet = wavy_sheet();
  for (const Eigen::Vector3f& position_m : sheet.positions_m)
    sheet.texture_coordinates.emplace_back(position_m.head<2>());
  const auto half = static_cast<std::uint32_t>(sheet.triangles.size() / 2),
             all = static_cast<std::uint32_t>(sheet.triangles.size());
  sheet.pages = {{ColorImage(4, 4), 0, half}, {ColorImage(2, 2), half, all - half}};
  for (std::size_t i = 0; i < all; ++i) sheet.is_filled.push_back(i >= half ? 1 : 0);
  const output::TriangleMesh cut =
      edited(sheet, std::vector<ScanEdit>{
                        {EditKind::kRemoveInside, box_of(0.3, {0.2, -0.2, -1}, {0.7, 0.6, 1}), 0}});
  ASSERT_TRUE(output::check_mesh(cut).ok()) << output::check_mesh(cut).error().message;
  for (std::size_t i = 0; i < cut.positions_m.size(); ++i)
    EXPECT_LT((cut.texture_coordinates[i] - cut.positions_m[i].head<2>()).norm(), 1e-5f);
  ASSERT_EQ(cut.pages.size(), 2u);
  for (std::size_t i = 0; i < cut.triangles.size(); ++i)
    EXPECT_EQ(cut.is_filled[i], i >= cut.pages[1].first_triangle ? 1 : 0);
  EXPECT_EQ(cut.pages[0].image.width, 4);
  // The second page is the half beyond y = 0.5: without it, the first is alone.
  const output::TriangleMesh first = edited(
      sheet,
      std::vector<ScanEdit>{{EditKind::kKeepInside, box_of(0, {-1, -1, -1}, {2, 0.4, 1}), 0}});
  ASSERT_EQ(first.pages.size(), 1u);
  EXPECT_EQ(first.pages[0].image.width, 4);
  EXPECT_TRUE(output::check_mesh(first).ok());
}

output::TriangleMesh joined(output::TriangleMesh a, const output::TriangleMesh& b,
                            const Eigen::Vector3f& moved_m) {
  const auto first = static_cast<std::uint32_t>(a.positions_m.size());
  for (const Eigen::Vector3f& position_m : b.positions_m)
    a.positions_m.push_back(position_m + moved_m);
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  a.colors.insert(a.colors.end(), b.colors.begin(), b.colors.end());
  for (const auto& [i, j, k] : b.triangles)
    a.triangles.push_back({first + i, first + j, first + k});
  return a;
}

TEST(Edited, FloatingPartsGoByTheirSize) {
  const auto whole = [](int, int) { return false; };
  const output::TriangleMesh large = mesh::grid_mesh(40, 0.025f, whole),
                             small = mesh::grid_mesh(4, 0.025f, whole);
  const output::TriangleMesh both = joined(large, small, {0, 0, 0.5f});
  const auto left = [&](double smaller_than_m) {
    return edited(both, std::vector<ScanEdit>{{EditKind::kRemoveFloating, {}, smaller_than_m}})
        .triangles.size();
  };
  EXPECT_EQ(left(0.14), both.triangles.size()) << "its diagonal is 0.141 m";
  EXPECT_EQ(left(0.15), large.triangles.size());
  EXPECT_EQ(left(9), large.triangles.size()) << "the largest part stays";
  // Charts of a texture have their vertices twice: what touches is one part.
  const output::TriangleMesh touching = joined(large, small, {1, 0, 0});
  EXPECT_EQ(edited(touching, std::vector<ScanEdit>{{EditKind::kRemoveFloating, {}, 0.5}})
                .triangles.size(),
            touching.triangles.size());
  // What a box has cut off may float.
  const std::vector<ScanEdit> edits{
      {EditKind::kRemoveInside, box_of(0, {0.9, -1, -1}, {0.95, 2, 1}), 0},
      {EditKind::kRemoveInside, box_of(0, {0.9, 0.05, -1}, {2, 0.1, 1}), 0},
      {EditKind::kRemoveFloating, {}, 0.1}};
  EXPECT_NEAR(total_m2(edited(large, edits)), 0.9 + 0.05 * 0.9, 1e-5);
}

TEST(Edited, PointsToo) {
  output::Cloud cloud = mesh::cube(1.0f, 0.02f);
  const std::size_t of_cube = cloud.size();
  for (const output::CloudPoint& point : mesh::sphere(0.05f, 200, {1, 0, 0}))
    cloud.push_back(point);
  EXPECT_EQ(edited(cloud, std::vector<ScanEdit>{{EditKind::kRemoveFloating, {}, 0.3}}).size(),
            of_cube);
  EXPECT_EQ(edited(cloud, std::vector<ScanEdit>{{EditKind::kRemoveFloating, {}, 0.1}}).size(),
            cloud.size());
  const EditBox box = box_of(0, {-0.6, -0.6, -0.6}, {0, 0.6, 0.6});
  const output::Cloud inside =
      edited(cloud, std::vector<ScanEdit>{{EditKind::kKeepInside, box, 0}});
  const output::Cloud outside =
      edited(cloud, std::vector<ScanEdit>{{EditKind::kRemoveInside, box, 0}});
  EXPECT_EQ(inside.size() + outside.size(), cloud.size());
  EXPECT_EQ(inside.size(), 50u * 50 + 4 * 25 * 50);
  EXPECT_TRUE(std::all_of(outside.begin(), outside.end(), [](const output::CloudPoint& point) {
    return point.position_m.x() > 0;
  }));
}

TEST(Edited, PointsThatAreNowhereOrFarAwayDoNoHarm) {
  output::Cloud cloud = mesh::cube(0.4f, 0.02f);
  const std::size_t of_cube = cloud.size();
  cloud.push_back(
      mesh::surfel_at({std::numeric_limits<float>::quiet_NaN(), 0, 0}, Eigen::Vector3f::UnitZ()));
  cloud.push_back(mesh::surfel_at({3e38f, -3e38f, 0}, Eigen::Vector3f::UnitZ()));
  EXPECT_EQ(edited(cloud, std::vector<ScanEdit>{{EditKind::kRemoveFloating, {}, 0.2}}).size(),
            of_cube + 1);
}

}  // namespace
}  // namespace hermite::edit
