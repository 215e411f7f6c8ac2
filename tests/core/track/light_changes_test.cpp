#include "core/track/light_changes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/support/swaying_camera.h"

namespace hermite::track::light_changes_test {
namespace {

using test::count;
using test::kCoarseCamera;
using test::kCoarsePixels;
using test::swaying_pose;

constexpr double kWall_m = 2;

using Grey = std::function<double(const Eigen::Vector3d& point_world)>;

// A wall 2 m away.
frame::CoarseView wall(const Rigid3& world_from_camera, const Grey& grey) {
  frame::CoarseView view{kCoarseCamera, std::vector<float>(kCoarsePixels),
                         std::vector<Eigen::Vector3f>(kCoarsePixels),
                         std::vector<float>(kCoarsePixels)};
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const std::size_t i = view.index(x, y);
      const Eigen::Vector3d ray((x - 39.5) / 65.6, (y - 29.5) / 65.6, 1);
      const double depth_m =
          (kWall_m - world_from_camera.translation.z()) / (world_from_camera.rotation * ray).z();
      view.depth_m[i] = static_cast<float>(depth_m);
      view.normals[i] =
          (world_from_camera.rotation.conjugate() * Eigen::Vector3d::UnitZ()).cast<float>();
      view.grey[i] =
          static_cast<float>(std::clamp(grey(world_from_camera * (depth_m * ray)), 0.0, 255.0));
    }
  return view;
}

double plaster(const Eigen::Vector3d& point) {
  return 110 + 8 * std::sin(7 * point.x()) * std::cos(9 * point.y());
}

// Checks of 10 cm.
double tiles(const Eigen::Vector3d& point) {
  return std::lround(std::floor(point.x() / 0.1) + std::floor(point.y() / 0.1)) % 2 == 0 ? 170 : 50;
}

double spot_x_m(int frame) { return 0.01 * frame - 0.3; }

// A spot of sun of 0.6 m that moves by a centimetre a frame.
Grey in_sun(int frame) {
  return [frame](const Eigen::Vector3d& point) {
    const bool is_lit = std::hypot(point.x() - spot_x_m(frame), point.y()) < 0.3;
    return plaster(point) * (is_lit ? 1.8 : 1);
  };
}

constexpr int kLast = 40;

// What changes in the last of 41 frames, taken to be seen from `seen_from`.
frame::CoarseMask changed_at_last(const std::function<Grey(int frame)>& grey,
                                  const Rigid3& seen_from = swaying_pose(kLast),
                                  const frame::CoarseMask& moving = frame::CoarseMask(kCoarsePixels,
                                                                                      0)) {
  LightChanges changes;
  for (int frame = 0; frame < kLast; ++frame)
    changes.remember(wall(swaying_pose(frame), grey(frame)), swaying_pose(frame),
                     frame::CoarseMask(kCoarsePixels, 0), frame::CoarseMask(kCoarsePixels, 0));
  return changes.changed(wall(swaying_pose(kLast), grey(kLast)), seen_from, moving);
}

TEST(LightChanges, TheEdgesOfASpotThatMovesAreFound) {
  const frame::CoarseMask changed = changed_at_last(in_sun);
  const frame::CoarseView view = wall(swaying_pose(kLast), in_sun(kLast));
  int edge = 0, edge_found = 0, away = 0, away_found = 0;
  for (int y = 1; y < 59; ++y)
    for (int x = 1; x < 79; ++x) {
      const Eigen::Vector3d point = swaying_pose(kLast) * view.point(x, y);
      const Eigen::Vector2d from_spot(point.x() - spot_x_m(kLast), point.y());
      // Also where it moves along itself, above and below.
      if (std::abs(from_spot.norm() - 0.3) < 0.02) {
        ++edge;
        edge_found += static_cast<int>(changed[view.index(x, y)]);
      } else if (std::abs(from_spot.x()) > 0.75 || std::abs(from_spot.y()) > 0.45) {
        ++away;
        away_found += static_cast<int>(changed[view.index(x, y)]);
      }
    }
  EXPECT_GT(edge, 20);
  EXPECT_EQ(edge_found, edge);
  EXPECT_EQ(away_found, 0) << "of " << away;
}

TEST(LightChanges, ExposureIsNotLightThatMoves) {
  const auto exposed = [](int frame) -> Grey {
    return [gain = 1 + 0.2 * std::sin(0.2 * frame)](const Eigen::Vector3d& point) {
      return gain * in_sun(30)(point);
    };
  };
  EXPECT_EQ(count(changed_at_last(exposed)), 0u);
}

TEST(LightChanges, ASpotThatRestsIsSeenALittleAsideAndIsTheSame) {
  const Rigid3 aside =
      swaying_pose(kLast) * exp_se3((Vector6d() << 0.01, 0.01, 0, 0, 0, 0.003).finished());
  const auto still = [](int /*frame*/) -> Grey { return in_sun(30); };
  EXPECT_EQ(count(changed_at_last(still, aside)), 0u);
}

TEST(LightChanges, AmongManyEdgesNoneIsLeftOut) {
  const auto tiled = [](int frame) -> Grey {
    return
        [frame](const Eigen::Vector3d& point) { return in_sun(frame)(point) * tiles(point) / 200; };
  };
  EXPECT_EQ(count(changed_at_last(tiled)), 0u);
}

TEST(LightChanges, BandsOfMainsLightAreTheExposureOfRows) {
  const auto bands = [](int frame) -> Grey {
    return [frame](const Eigen::Vector3d& point) {
      return plaster(point) * (1 + 0.12 * std::sin(7 * point.y() + 0.9 * frame));
    };
  };
  EXPECT_LT(count(changed_at_last(bands)), kCoarsePixels / 50)
      << "some along the border, whose rows have neighbours on one side";
}

TEST(LightChanges, WhereMostOfTheLightChangesNothingIsKnown) {
  const auto waves = [](int frame) -> Grey {
    return [frame](const Eigen::Vector3d& point) {
      return plaster(point) * (1 + 0.5 * std::sin(5 * point.x() + 0.9 * frame));
    };
  };
  EXPECT_EQ(count(changed_at_last(waves)), 0u);
}

TEST(LightChanges, WhatMovesIsNotAsked) {
  EXPECT_EQ(
      count(changed_at_last(in_sun, swaying_pose(kLast), frame::CoarseMask(kCoarsePixels, 1))), 0u);
}

TEST(LightChanges, WithoutEarlierViewsThereAreNone) {
  EXPECT_EQ(count(LightChanges{}.changed(wall(swaying_pose(0), plaster), swaying_pose(0),
                                         frame::CoarseMask(kCoarsePixels, 0))),
            0u);
  LightChanges changes;
  changes.remember(wall(swaying_pose(0), in_sun(30)), swaying_pose(0),
                   frame::CoarseMask(kCoarsePixels, 0), frame::CoarseMask(kCoarsePixels, 0));
  changes.forget();
  EXPECT_EQ(count(changes.changed(wall(swaying_pose(0), plaster), swaying_pose(0),
                                  frame::CoarseMask(kCoarsePixels, 0))),
            0u);
}

TEST(LightChanges, AreExpectedWhereTheyWereAndGoOnFromWhatWasSaved) {
  LightChanges changes;
  const frame::CoarseView view = wall(swaying_pose(3), plaster);
  frame::CoarseMask changed(kCoarsePixels, 0);
  changed[view.index(40, 30)] = 1;
  changes.remember(view, swaying_pose(3), frame::CoarseMask(kCoarsePixels, 0), changed);
  ByteWriter saved;
  changes.save(saved);
  LightChanges restored;
  const std::string bytes = saved.take();
  ByteReader reader(bytes);
  restored.restore(reader);
  ASSERT_TRUE(reader.ok());
  for (const LightChanges* some : {&changes, &restored}) {
    const frame::CoarseMask expected = some->expected(wall(swaying_pose(4), plaster));
    EXPECT_EQ(expected[view.index(40, 30)], 1u);
    EXPECT_EQ(count(expected), 25u);
    EXPECT_GT(count(some->changed(wall(swaying_pose(4), in_sun(30)), swaying_pose(4),
                                  frame::CoarseMask(kCoarsePixels, 0))),
              0u);
  }
}

}  // namespace
}  // namespace hermite::track::light_changes_test
