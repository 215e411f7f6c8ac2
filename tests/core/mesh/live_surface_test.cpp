#include "core/mesh/live_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>

#include "core/evaluate/mesh_validity.h"
#include "tests/core/mesh/mesh_shapes.h"

namespace hermite::mesh {
namespace {

using std::chrono::milliseconds;
using testing::IsEmpty;
using Time = LiveSurface::Time;

constexpr double kLiveCell_m = 0.02;  // a cube has 64 cm
const Eigen::Vector3f kEye_m = Eigen::Vector3f::Zero();

std::vector<output::SlotChange> changes_of(const output::Cloud& cloud,
                                           std::uint32_t first_slot = 0) {
  std::vector<output::SlotChange> changes;
  for (const output::CloudPoint& point : cloud) changes.push_back({first_slot++, true, point});
  return changes;
}

output::Cloud square(float side_m, const Eigen::Vector3f& middle_m = {0.3f, 0.3f, 0.3f}) {
  output::Cloud cloud;
  append_square(cloud, side_m, 0.016f);
  for (output::CloudPoint& point : cloud) point.position_m += middle_m;
  return cloud;
}

PlacedSubmap placed(double x_m, std::uint32_t part = 0) {
  PlacedSubmap submap{Rigid3{}, part};
  submap.world_from_submap.translation.x() = x_m;
  return submap;
}

// What a viewer would show, and the clock.
struct Watched {
  LiveSurface surface{kLiveCell_m};
  std::map<SurfaceCube, CubeMesh> shown;
  Time now{};
  std::size_t made = 0, emptied = 0;

  explicit Watched(const std::vector<PlacedSubmap>& submaps = {PlacedSubmap{}}) {
    surface.place(submaps, now);
  }

  // All that is due after a rest.
  void contour_all() {
    now += kCubeRest;
    while (const std::optional<SurfaceCube> cube = surface.next(kEye_m, now)) {
      ++made;
      std::optional<CubeMesh> mesh = surface.contour(*cube, now);
      if (!mesh) continue;
      emptied += mesh->mesh.triangles.empty() ? 1 : 0;
      if (mesh->mesh.triangles.empty())
        shown.erase(*cube);
      else
        shown.insert_or_assign(*cube, *std::move(mesh));
    }
  }
  std::size_t triangle_count() const {
    std::size_t count = 0;
    for (const auto& [cube, mesh] : shown) count += mesh.mesh.triangles.size();
    return count;
  }
};

void expect_same(const Watched& a, const Watched& b) {
  ASSERT_EQ(a.shown.size(), b.shown.size());
  for (const auto& [cube, mesh] : a.shown) {
    ASSERT_TRUE(b.shown.contains(cube));
    const CubeMesh& other = b.shown.at(cube);
    EXPECT_EQ(mesh.submap, other.submap);
    EXPECT_EQ(mesh.mesh.triangles, other.mesh.triangles);
    EXPECT_EQ(mesh.mesh.positions_m, other.mesh.positions_m);
    EXPECT_EQ(mesh.mesh.normals, other.mesh.normals);
    EXPECT_TRUE(mesh.mesh.colors == other.mesh.colors);
    EXPECT_EQ(mesh.mesh.confidence_eighths, other.mesh.confidence_eighths);
  }
}

// Pieces in the world as one mesh, in which vertices at the same place are one.
output::TriangleMesh welded(const std::map<SurfaceCube, CubeMesh>& shown) {
  output::TriangleMesh whole;
  std::map<std::array<float, 3>, std::uint32_t> number;
  for (const auto& [cube, piece] : shown) {
    std::vector<std::uint32_t> number_of_vertex;
    for (std::size_t i = 0; i < piece.mesh.positions_m.size(); ++i) {
      const Eigen::Vector3f& at_m = piece.mesh.positions_m[i];
      const auto [found, is_new] = number.try_emplace({at_m.x(), at_m.y(), at_m.z()},
                                                      static_cast<std::uint32_t>(number.size()));
      if (is_new) whole.positions_m.push_back(at_m);
      if (is_new) whole.normals.push_back(piece.mesh.normals[i]);
      number_of_vertex.push_back(found->second);
    }
    for (const output::TriangleCorners& t : piece.mesh.triangles)
      whole.triangles.push_back(
          {number_of_vertex[t[0]], number_of_vertex[t[1]], number_of_vertex[t[2]]});
  }
  return whole;
}

TEST(LiveSurface, PiecesOfNeighboursFitWithoutAGap) {
  Watched watched;
  // The origin is a corner of eight cubes.
  watched.surface.apply(changes_of(sphere(0.2f, 1500)), watched.now);
  watched.contour_all();
  EXPECT_EQ(watched.shown.size(), 8u);
  const output::TriangleMesh whole = welded(watched.shown);
  EXPECT_GT(whole.triangles.size(), 1500u);
  const evaluate::MeshValidity validity = evaluate::mesh_validity(whole);
  EXPECT_EQ(validity.border_edges, 0);
  EXPECT_EQ(validity.overfull_edges, 0);
  EXPECT_EQ(validity.disagreeing_edges, 0);
  double worst_m = 0;
  for (const Eigen::Vector3f& position_m : whole.positions_m)
    worst_m = std::max(worst_m, std::abs(static_cast<double>(position_m.norm()) - 0.2));
  EXPECT_LT(worst_m, 0.002);
}

TEST(LiveSurface, AfterAnyChangesItIsWhatItWouldBeFromNothing) {
  Watched watched({placed(0), placed(0.1)});
  output::Cloud cloud = square(0.9f);
  for (output::CloudPoint& point : cloud) {
    if (point.position_m.x() < 0.3f) continue;
    point.submap = 1;
    point.position_m.x() -= 0.1f;
  }
  std::mt19937 random(3);
  std::vector<bool> is_there(cloud.size(), false);
  for (int round = 0; round < 4; ++round) {
    std::vector<output::SlotChange> changes;
    for (std::uint32_t slot = 0; slot < cloud.size(); ++slot) {
      if (random() % 3 != 0) continue;
      is_there[slot] = round < 2 || random() % 2 == 0;
      if (random() % 2 == 0)
        cloud[slot].position_m.z() += 0.004f * (static_cast<float>(random() % 3) - 1);
      changes.push_back({slot, is_there[slot], cloud[slot]});
    }
    watched.surface.apply(changes, watched.now);
    watched.contour_all();
  }
  EXPECT_GT(watched.triangle_count(), 500u);
  Watched fresh({placed(0), placed(0.1)});
  std::vector<output::SlotChange> all = changes_of(cloud);
  std::erase_if(all,
                [&is_there](const output::SlotChange& change) { return !is_there[change.slot]; });
  std::reverse(all.begin(), all.end());  // nor does the order matter
  fresh.surface.apply(all, fresh.now);
  fresh.contour_all();
  expect_same(watched, fresh);
}

TEST(LiveSurface, WhatChangesDirtiesItsCubeAndNoOther) {
  Watched watched;
  watched.surface.apply(changes_of(square(0.3f)), watched.now);  // within one cube
  watched.surface.apply(changes_of(square(0.3f, {2.2f, 0.3f, 0.3f}), 10'000), watched.now);
  watched.contour_all();
  ASSERT_EQ(watched.shown.size(), 2u);
  output::CloudPoint point = square(0.3f)[100];
  point.position_m.z() += 0.0005f;  // a fortieth of a cell
  point.confidence += 0.5f;
  watched.surface.apply(std::vector<output::SlotChange>{{100, true, point}}, watched.now);
  EXPECT_EQ(watched.surface.dirty_count(), 0u) << "nobody would see it";
  point.position_m.z() += 0.005f;
  watched.surface.apply(std::vector<output::SlotChange>{{100, true, point}}, watched.now);
  EXPECT_EQ(watched.surface.dirty_count(), 1u);
  EXPECT_EQ(watched.surface.next(kEye_m, watched.now), std::nullopt) << "it rests";
  watched.now += kCubeRest;
  EXPECT_EQ(watched.surface.next(kEye_m, watched.now), (SurfaceCube{0, 0, 0, 0}));
}

// What viewers get of points is the same number.
TEST(LiveSurface, VerticesHaveTheConfidencesOfTheirSurfels) {
  for (const float confidence : {1.0f, 5.0f, 12.0f, 20.0f, 90.0f}) {
    output::Cloud cloud = square(0.3f);
    for (output::CloudPoint& point : cloud) point.confidence = confidence;
    Watched watched;
    watched.surface.apply(changes_of(cloud), watched.now);
    watched.contour_all();
    ASSERT_EQ(watched.shown.size(), 1u);
    const output::TriangleMesh& mesh = watched.shown.begin()->second.mesh;
    EXPECT_EQ(mesh.confidence_eighths,
              std::vector<std::uint8_t>(mesh.positions_m.size(),
                                        output::eighths_of_confidence(confidence)));
  }
}

TEST(LiveSurface, ConfidencesAreBlendedFromOneSideToTheOther) {
  output::Cloud cloud = square(0.3f);
  for (output::CloudPoint& point : cloud) point.confidence = point.position_m.x() < 0.3f ? 4 : 20;
  Watched watched;
  watched.surface.apply(changes_of(cloud), watched.now);
  watched.contour_all();
  ASSERT_EQ(watched.shown.size(), 1u);
  const output::TriangleMesh& mesh = watched.shown.begin()->second.mesh;
  std::size_t between = 0;
  for (std::size_t i = 0; i < mesh.positions_m.size(); ++i) {
    const int eighths = mesh.confidence_eighths[i];
    EXPECT_GE(eighths, 32);
    EXPECT_LE(eighths, 160);
    const float x_m = mesh.positions_m[i].x();
    if (x_m < 0.2f || x_m > 0.4f) {
      EXPECT_EQ(eighths, x_m < 0.2f ? 32 : 160);
    }
    between += eighths > 32 && eighths < 160 ? 1 : 0;
  }
  EXPECT_GT(between, 0u);
}

TEST(LiveSurface, AConfidenceThatPassesAStepOfCoverageIsToldAndTheSurfaceStaysAsItIs) {
  Watched watched;
  output::Cloud cloud = square(0.3f);
  for (output::CloudPoint& point : cloud) point.confidence = 7;
  watched.surface.apply(changes_of(cloud), watched.now);
  watched.contour_all();
  ASSERT_EQ(watched.shown.size(), 1u);
  const output::TriangleMesh before = watched.shown.begin()->second.mesh;
  for (output::CloudPoint& point : cloud) point.confidence = 11.5f;
  watched.surface.apply(changes_of(cloud), watched.now);
  EXPECT_EQ(watched.surface.dirty_count(), 0u) << "it has the same colour of coverage";
  for (output::CloudPoint& point : cloud) point.confidence = 13;
  watched.surface.apply(changes_of(cloud), watched.now);
  EXPECT_GT(watched.surface.dirty_count(), 0u);
  watched.contour_all();
  const output::TriangleMesh& after = watched.shown.begin()->second.mesh;
  EXPECT_EQ(after.positions_m, before.positions_m);
  EXPECT_EQ(after.triangles, before.triangles);
  EXPECT_TRUE(after.colors == before.colors);
  EXPECT_EQ(after.confidence_eighths, std::vector<std::uint8_t>(after.positions_m.size(), 8 * 13));
  for (output::CloudPoint& point : cloud) point.confidence = 90;
  watched.surface.apply(changes_of(cloud), watched.now);
  EXPECT_EQ(watched.surface.dirty_count(), 0u);
}

TEST(LiveSurface, ACubeThatLosesAllIsToldOfAsEmptyOnce) {
  Watched watched;
  std::vector<output::SlotChange> changes = changes_of(square(0.3f));
  watched.surface.apply(changes, watched.now);
  watched.contour_all();
  ASSERT_EQ(watched.surface.shown().size(), 1u);
  for (output::SlotChange& change : changes) change.alive = false;
  watched.surface.apply(changes, watched.now);
  EXPECT_TRUE(watched.surface.next(kEye_m, watched.now)) << "what vanishes does so at once";
  watched.contour_all();
  EXPECT_EQ(watched.emptied, 1u);
  EXPECT_THAT(watched.surface.shown(), IsEmpty());
  EXPECT_EQ(watched.surface.surfel_count(), 0u);
  watched.surface.apply(changes, watched.now);
  watched.contour_all();
  EXPECT_EQ(watched.emptied, 1u);
}

TEST(LiveSurface, ASubmapThatMovesIsContouredAnewWhereItIsThen) {
  Watched watched({placed(0)});
  watched.surface.apply(changes_of(square(0.3f)), watched.now);
  watched.contour_all();
  watched.surface.place(std::vector{placed(0.3 * kMoved_cells * kLiveCell_m)}, watched.now);
  EXPECT_EQ(watched.surface.dirty_count(), 0u) << "its mesh moves with it, and is right";
  watched.surface.place(std::vector{placed(2)}, watched.now);
  EXPECT_GE(watched.surface.dirty_count(), 2u) << "where it was and where it is";
  watched.contour_all();
  EXPECT_EQ(watched.emptied, 1u);
  Watched fresh({placed(2)});
  fresh.surface.apply(changes_of(square(0.3f)), fresh.now);
  fresh.contour_all();
  expect_same(watched, fresh);
}

TEST(LiveSurface, SubmapsThatOverlapHaveOneSurfaceUnlessTheyAreOfTwoParts) {
  output::Cloud again = square(0.3f);
  for (output::CloudPoint& point : again) {
    point.position_m.x() -= 0.5f;
    point.position_m.z() += 0.002f;
    point.submap = 1;
    point.confidence = 9;
  }
  Watched alone, both({placed(0), placed(0.5)}), apart({placed(0), placed(0.5, 1)});
  for (Watched* watched : {&alone, &both, &apart}) {
    watched->surface.apply(changes_of(square(0.3f)), watched->now);
    if (watched != &alone) watched->surface.apply(changes_of(again, 5000), watched->now);
    watched->contour_all();
  }
  ASSERT_EQ(both.shown.size(), 1u);
  EXPECT_NEAR(
      static_cast<double>(both.triangle_count()) / static_cast<double>(alone.triangle_count()), 1,
      0.1);
  const CubeMesh& piece = both.shown.begin()->second;
  EXPECT_EQ(piece.submap, 1u) << "that more is known of";
  EXPECT_NEAR(piece.mesh.positions_m[0].x() + 0.5f, 0.3f, 0.2f) << "in its frame";
  EXPECT_EQ(apart.shown.size(), 2u);
  EXPECT_TRUE(apart.shown.contains({1, 0, 0, 0}));
}

TEST(LiveSurface, WhatIsNewComesFirstAndNearTheEye) {
  Watched watched;
  watched.surface.apply(changes_of(square(0.3f)), watched.now);
  watched.contour_all();
  output::Cloud paler = square(0.3f);
  for (output::CloudPoint& point : paler) point.color = {255, 255, 255};
  watched.surface.apply(changes_of(paler), watched.now);
  watched.now += milliseconds(10);
  watched.surface.apply(changes_of(square(0.3f, {4.1f, 0.3f, 0.3f}), 5000), watched.now);
  watched.surface.apply(changes_of(square(0.3f, {2.2f, 0.3f, 0.3f}), 9000), watched.now);
  const Eigen::Vector3f eye_m(3, 0, 0);
  std::vector<int> order;
  watched.now += kCubeRest;
  while (const std::optional<SurfaceCube> cube = watched.surface.next(eye_m, watched.now)) {
    const std::optional<CubeMesh> made = watched.surface.contour(*cube, watched.now);
    if (!made) continue;  // reached by supports, not by the surface
    order.push_back(cube->x);
    EXPECT_EQ(watched.now - made->since, cube->x == 0 ? kCubeRest + milliseconds(10) : kCubeRest);
  }
  EXPECT_EQ(order, (std::vector<int>{3, 6, 0}));
}

TEST(LiveSurface, SurfelsThatAreNoneAreLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Watched watched;
  const output::CloudPoint good = surfel_at({0.3f, 0.3f, 0.3f}, Eigen::Vector3f::UnitZ());
  output::Cloud bad(5, good);
  bad[0].position_m.x() = kNan;
  bad[1].normal = Eigen::Vector3f::Zero();
  bad[2].confidence = kNan;
  bad[3].position_m.y() = 1e9f;
  bad[4].confidence = 0;
  watched.surface.apply(changes_of(output::Cloud(5, good)), watched.now);
  EXPECT_EQ(watched.surface.surfel_count(), 5u);
  watched.surface.apply(changes_of(bad), watched.now);
  EXPECT_EQ(watched.surface.surfel_count(), 0u) << "what their slots held is gone";
  watched.contour_all();
  EXPECT_THAT(watched.shown, IsEmpty());
}

TEST(LiveCell, GoesByTheDistanceOfSurfels) {
  EXPECT_EQ(live_cell_m({}), std::nullopt);
  EXPECT_EQ(
      live_cell_m(changes_of(output::Cloud(199, surfel_at({0, 0, 0}, Eigen::Vector3f::UnitZ())))),
      std::nullopt);
  // Diagonal neighbours are the eighth.
  EXPECT_NEAR(*live_cell_m(changes_of(square(0.9f))), 1.25 * 0.016, 0.0025);
  EXPECT_EQ(
      live_cell_m(changes_of(output::Cloud(300, surfel_at({0, 0, 0}, Eigen::Vector3f::UnitZ())))),
      0.01)
      << "not finer";
}

}  // namespace
}  // namespace hermite::mesh
