#include "core/mesh/contour.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "core/evaluate/mesh_validity.h"
#include "core/mesh/contour_cube.h"
#include "core/mesh/mesh_parts.h"
#include "core/mesh/quad_mesh.h"
#include "core/output/mesh_ply.h"
#include "tests/core/mesh/expect_sound.h"
#include "tests/core/mesh/mesh_shapes.h"

namespace hermite::mesh {
namespace {

using testing::HasSubstr;

output::TriangleMesh mesh_of_cloud(const output::Cloud& cloud, double cell_m = 0.01) {
  ContourOptions options;
  options.field.cell_m = cell_m;
  Result<output::TriangleMesh> mesh = contour(cloud, options);
  EXPECT_TRUE(mesh.ok());
  return *std::move(mesh);
}

double greatest(const output::TriangleMesh& mesh,
                const std::function<double(const Eigen::Vector3f&)>& error_m) {
  double worst_m = 0;
  for (const Eigen::Vector3f& position_m : mesh.positions_m)
    worst_m = std::max(worst_m, std::abs(error_m(position_m)));
  return worst_m;
}

TEST(Contour, ASphereIsClosedAndRound) {
  const float radius_m = 0.2f;
  const output::TriangleMesh mesh = mesh_of_cloud(sphere(radius_m, 5000));
  expect_sound(mesh);
  EXPECT_EQ(evaluate::mesh_validity(mesh).border_edges, 0);
  EXPECT_EQ(evaluate::mesh_validity(mesh).components, 1);
  EXPECT_LT(
      greatest(mesh,
               [&](const Eigen::Vector3f& p) { return static_cast<double>(p.norm() - radius_m); }),
      2e-4);
  for (std::size_t i = 0; i < mesh.positions_m.size(); ++i)
    ASSERT_GT(mesh.normals[i].dot(mesh.positions_m[i].normalized()), 0.99f) << i;
  const Rgb8 color = mesh.colors.front();
  EXPECT_EQ(color, (Rgb8{200, 100, 50}));
}

// Across the border of cubes, too: the sphere lies in eight of them.
TEST(Contour, HasNoCrackBetweenCubes) {
  const output::TriangleMesh mesh = mesh_of_cloud(sphere(0.35f, 9000), 0.02);
  expect_sound(mesh);
  EXPECT_EQ(evaluate::mesh_validity(mesh).border_edges, 0);
}

// As with all cubes in memory at once.
output::TriangleMesh welded_at_once(const SurfelField& field) {
  constexpr int kMostCubes = 3;  // from the middle
  CubeSurface whole;
  std::vector<CubeQuad> quads;
  for (int z = -kMostCubes; z < kMostCubes; ++z)
    for (int y = -kMostCubes; y < kMostCubes; ++y)
      for (int x = -kMostCubes; x < kMostCubes; ++x) {
        const CubeSurface surface = contour_cube(field, {x, y, z});
        whole.vertices.insert(whole.vertices.end(), surface.vertices.begin(),
                              surface.vertices.end());
        quads.insert(quads.end(), surface.quads.begin(), surface.quads.end());
      }
  std::map<VertexKey, std::uint32_t> numbers;
  for (const CubeVertex& vertex : whole.vertices)
    numbers.emplace(vertex.key, static_cast<std::uint32_t>(numbers.size()));
  QuadMesh mesh;
  mesh.add_vertices(whole.vertices);
  for (const CubeQuad& quad : quads)
    mesh.add({numbers.at(quad[0]), numbers.at(quad[1]), numbers.at(quad[2]), numbers.at(quad[3])});
  return mesh.take();
}

TEST(Contour, ForgettingLayersOfCubesChangesNoByte) {
  const output::Cloud cloud = sphere(0.35f, 2500);
  ContourOptions options;
  options.field.cell_m = 0.01;  // four layers of cubes
  output::TriangleMesh at_once = welded_at_once(*SurfelField::create(cloud, options.field));
  unfold(at_once);
  split_touching_fans(at_once);
  remove_small_parts(at_once, options.least_part_m2);
  ASSERT_GT(at_once.triangles.size(), 20'000u);
  EXPECT_EQ(output::format_mesh_ply(*contour(cloud, options)), output::format_mesh_ply(at_once));
  EXPECT_EQ(output::format_mesh_ply(*contour(output::Cloud(cloud), options)),
            output::format_mesh_ply(at_once))
      << "of a cloud that is handed over";
}

// The corners of a cube lie between the grid's.
TEST(Contour, EdgesStayEdges) {
  const float side_m = 0.306f;
  const output::TriangleMesh mesh = mesh_of_cloud(cube(side_m, 0.009f));
  expect_sound(mesh);
  EXPECT_EQ(evaluate::mesh_validity(mesh).border_edges, 0);
  const auto off_m = [&](const Eigen::Vector3f& p) {
    return static_cast<double>(p.cwiseAbs().maxCoeff() - side_m / 2);
  };
  EXPECT_LT(greatest(mesh, off_m), 1e-3);
  // A rounded edge of the field's support of 27 mm would be 4 mm short.
  double farthest_m = 0;
  for (const Eigen::Vector3f& p : mesh.positions_m)
    farthest_m = std::max(farthest_m, static_cast<double>(p.norm()));
  EXPECT_GT(farthest_m, std::sqrt(3.0) * static_cast<double>(side_m) / 2 - 2e-3);
}

TEST(Contour, ASquareIsOpenAndAsWideAsItsPoints) {
  output::Cloud cloud;
  append_square(cloud, 0.4f, 0.01f, 0.0031f);
  const output::TriangleMesh mesh = mesh_of_cloud(cloud);
  expect_sound(mesh);
  EXPECT_EQ(evaluate::mesh_validity(mesh).components, 1);
  EXPECT_LT(
      greatest(mesh, [](const Eigen::Vector3f& p) { return static_cast<double>(p.z() - 0.0031f); }),
      1e-5);
  double widest_m = 0;
  for (const Eigen::Vector3f& p : mesh.positions_m)
    widest_m = std::max(widest_m, static_cast<double>(p.cwiseAbs().maxCoeff()));
  EXPECT_NEAR(widest_m, 0.2, 0.0101);
}

// A hole of 12 cm is a hole, and nothing hangs in it.
TEST(Contour, PutsNoCurtainOverAHole) {
  output::Cloud cloud;
  append_square(cloud, 0.4f, 0.01f);
  std::erase_if(cloud, [](const output::CloudPoint& point) {
    return point.position_m.cwiseAbs().maxCoeff() < 0.06f;
  });
  for (const Eigen::Vector3f& p : mesh_of_cloud(cloud).positions_m)
    ASSERT_GT(p.cwiseAbs().maxCoeff(), 0.045f);
}

// An image on a wall, or the same wall from two submaps that were not joined well.
TEST(Contour, TwoSheetsFarApartAreTwoAndNearOnesAreOne) {
  output::Cloud far, near;
  for (const float z_m : {0.0f, 0.08f}) append_square(far, 0.3f, 0.01f, z_m);
  for (const float z_m : {0.0f, 0.006f}) append_square(near, 0.3f, 0.01f, z_m);
  expect_sound(mesh_of_cloud(far));
  expect_sound(mesh_of_cloud(near));
  EXPECT_EQ(evaluate::mesh_validity(mesh_of_cloud(far)).components, 2);
  EXPECT_EQ(evaluate::mesh_validity(mesh_of_cloud(near)).components, 1);
  EXPECT_LT(greatest(mesh_of_cloud(near),
                     [](const Eigen::Vector3f& p) { return static_cast<double>(p.z() - 0.003f); }),
            1e-3);
}

// A board of 3 cm has a front and a back.
TEST(Contour, AThinBoardHasTwoSides) {
  output::Cloud cloud;
  append_square(cloud, 0.3f, 0.006f, 0.03f);
  output::Cloud back;
  append_square(back, 0.3f, 0.006f, 0);
  for (output::CloudPoint& point : back) point.normal = -point.normal;
  cloud.insert(cloud.end(), back.begin(), back.end());
  const output::TriangleMesh mesh = mesh_of_cloud(cloud, 0.006);
  expect_sound(mesh);
  EXPECT_EQ(evaluate::mesh_validity(mesh).components, 2);
  EXPECT_LT(
      greatest(mesh,
               [](const Eigen::Vector3f& p) {
                 return static_cast<double>(std::min(std::abs(p.z()), std::abs(p.z() - 0.03f)));
               }),
      5e-4);
}

TEST(Contour, NoiseMakesNoFoldsAndNoDoubleEdges) {
  output::Cloud cloud = sphere(0.2f, 6000);
  std::uint32_t state = 7;
  const auto noise = [&state] {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) / 8388608.0f - 1.0f;
  };
  for (output::CloudPoint& point : cloud) {
    point.position_m += 0.004f * noise() * point.normal;
    point.normal = (point.normal + 0.5f * Eigen::Vector3f(noise(), noise(), noise())).normalized();
  }
  expect_sound(mesh_of_cloud(cloud, 0.006));
}

TEST(Contour, TheSameCloudGivesTheSameBytes) {
  const output::Cloud cloud = cube(0.25f, 0.01f);
  EXPECT_EQ(output::format_mesh_ply(mesh_of_cloud(cloud)),
            output::format_mesh_ply(mesh_of_cloud(cloud)));
}

// A cube alone is what the whole has of it: what is streamed piece by piece is what a file has.
TEST(Contour, CubesAreAloneWhatTheyAreTogether) {
  FieldOptions options;
  options.cell_m = 0.01;
  const output::Cloud all = sphere(0.2f, 5000);
  output::Cloud upper;
  std::copy_if(all.begin(), all.end(), std::back_inserter(upper),
               [](const output::CloudPoint& point) { return point.position_m.z() > 0.1f; });
  const SurfelField of_all = *SurfelField::create(all, options);
  const CubeSurface one = contour_cube(of_all, {0, 0, 0}), other = contour_cube(of_all, {0, 0, 0});
  ASSERT_FALSE(one.vertices.empty());
  EXPECT_TRUE(
      std::is_sorted(one.vertices.begin(), one.vertices.end(),
                     [](const CubeVertex& a, const CubeVertex& b) { return a.key < b.key; }));
  ASSERT_EQ(one.vertices.size(), other.vertices.size());
  for (std::size_t i = 0; i < one.vertices.size(); ++i)
    ASSERT_EQ(one.vertices[i].position_m, other.vertices[i].position_m);
  EXPECT_TRUE(contour_cube(of_all, {5, 5, 5}).vertices.empty());
}

TEST(Contour, KeysGoBackAndForth) {
  for (const Eigen::Vector3i& cell : {Eigen::Vector3i(0, 0, 0), Eigen::Vector3i(-1, 5, -70000),
                                      Eigen::Vector3i(kMostCell - 1, -kMostCell, 3)})
    EXPECT_EQ(cell_of(vertex_key(cell, 3)), cell);
  EXPECT_LT(vertex_key({9, 9, -1}, 11), vertex_key({-9, -9, 0}, 0));
}

TEST(Contour, LittleOrNothingIsNoFailure) {
  EXPECT_TRUE(mesh_of_cloud({surfel_at({1, 2, 3}, Eigen::Vector3f::UnitX())}).triangles.empty());
  output::Cloud ten;
  for (int i = 0; i < 10; ++i)
    ten.push_back(
        surfel_at({0.01f * static_cast<float>(i % 5), 0.01f * static_cast<float>(i / 5), 0},
                  Eigen::Vector3f::UnitZ()));
  EXPECT_TRUE(mesh_of_cloud(ten).triangles.empty()) << "less than the least part";
  output::Cloud twice(40, surfel_at({0, 0, 0}, Eigen::Vector3f::UnitZ()));
  EXPECT_TRUE(mesh_of_cloud(twice).triangles.empty()) << "all at one point";
  EXPECT_THAT(contour({}, {}).error().message, HasSubstr("no point"));
}

TEST(Contour, PartsFarApartAreBothThere) {
  output::Cloud cloud = sphere(0.1f, 1500);
  const output::Cloud other = sphere(0.1f, 1500, {900, -900, 400});
  cloud.insert(cloud.end(), other.begin(), other.end());
  const output::TriangleMesh mesh = mesh_of_cloud(cloud);
  EXPECT_EQ(evaluate::mesh_validity(mesh).components, 2);
  EXPECT_EQ(evaluate::mesh_validity(mesh).border_edges, 0);
}

TEST(Contour, CanBeStopped) {
  ContourOptions options;
  options.field.cell_m = 0.01;
  double last = 0;
  const auto stop_soon = [&last](double done) {
    last = done;
    return done < 0.3;
  };
  const Result<output::TriangleMesh> mesh = contour(sphere(0.3f, 8000), options, stop_soon);
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().code, ErrorCode::kBusy);
  EXPECT_LT(last, 0.6);
}

}  // namespace
}  // namespace hermite::mesh
