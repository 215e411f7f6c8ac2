#include "core/synthetic/world_paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/synthetic/synthetic_camera.h"

namespace hermite::synthetic::world_paths_test {
namespace {

using Eigen::Vector3d;

constexpr double kDegrees = 180 / M_PI;
constexpr double kStep_s = 1 / 30.0;

class WorldPath : public testing::TestWithParam<RoomScene> {
 protected:
  Rigid3 at(double time_s) const {
    return world_pose(GetParam(), time_s / world_lap_s(GetParam()));
  }
  double lap_s() const { return world_lap_s(GetParam()); }
};

TEST_P(WorldPath, IsAWalkWithAHandsSpeedAndWithoutJolts) {
  double fastest = 0, slowest = 1e9, fastest_turn = 0, hardest = 0;
  for (int i = 1; i * kStep_s < 2 * lap_s() + 1; ++i) {
    const Rigid3 before = at((i - 1) * kStep_s), here = at(i * kStep_s),
                 after = at((i + 1) * kStep_s);
    const double speed = (after.translation - here.translation).norm() / kStep_s;
    fastest = std::max(fastest, speed);
    slowest = std::min(slowest, speed);
    fastest_turn = std::max(
        fastest_turn, angle_rad(here.rotation.conjugate() * after.rotation) / kStep_s * kDegrees);
    hardest =
        std::max(hardest, (after.translation - 2 * here.translation + before.translation).norm() /
                              (kStep_s * kStep_s));
  }
  EXPECT_GT(slowest, 0.2);
  EXPECT_LT(fastest, 0.45);
  EXPECT_LT(fastest_turn, 40);
  EXPECT_LT(hardest, 1.0) << "m/s^2: the limit of the furnished room's path";
}

TEST_P(WorldPath, ClosesAfterALapAndRepeatsAfterTwo) {
  const RoomScene scene = GetParam();
  const auto apart = [&](double a, double b) {
    const Rigid3 first = world_pose(scene, a), second = world_pose(scene, b);
    return std::max((first.translation - second.translation).norm(),
                    angle_rad(first.rotation.conjugate() * second.rotation));
  };
  EXPECT_LT(apart(0, 1), 1e-9);
  for (const double laps : {0.0, 0.31, 0.77, 1.5}) EXPECT_LT(apart(laps, laps + 2), 1e-9) << laps;
  const double height_m =
      std::abs(world_pose(scene, 0.5).translation.z() - world_pose(scene, 1.5).translation.z());
  EXPECT_GT(height_m, 0.1) << "the second lap sees the same from elsewhere";
  EXPECT_LT(
      (world_pose(scene, 0.5).translation - world_pose(scene, 1.5).translation).head<2>().norm(),
      1e-9);
}

// The fourth differences of a curve with four continuous derivatives stay of the order of step^4,
// in the seam of a lap too.
TEST_P(WorldPath, IsSmoothAcrossTheSeamOfALap) {
  constexpr double kFine_s = 0.02;
  double largest = 0;
  for (double time_s = lap_s() - 1; time_s < lap_s() + 1; time_s += kFine_s) {
    Vector3d difference = Vector3d::Zero();
    constexpr double kBinomial[] = {1, -4, 6, -4, 1};
    for (int k = 0; k < 5; ++k) difference += kBinomial[k] * at(time_s + k * kFine_s).translation;
    largest = std::max(largest, difference.norm());
  }
  // m/s^4: the control points' fourth differences, at most 16 steps of 0.2 m each of 0.5 s, bound
  // the curve's fourth derivative.
  EXPECT_LT(largest / std::pow(kFine_s, 4), 16 * 0.2 / std::pow(0.5, 4));
}

TEST_P(WorldPath, StaysClearOfWallsAndFurniture) {
  const SyntheticRoom room(GetParam());
  double nearest_m = 1e9;
  for (double time_s = 0; time_s < 2 * lap_s(); time_s += 0.1)
    nearest_m = std::min(nearest_m, room.surface_distance(at(time_s).translation));
  EXPECT_GT(nearest_m, 0.4) << "doors are 0.87 m wide";
}

TEST_P(WorldPath, AlwaysSeesSomethingNearEnoughToMeasure) {
  const Camera camera{80, 60, 65.625, 65.625, 39.5, 29.5, 5000};
  const SyntheticRoom room(GetParam());
  for (double time_s = 0; time_s < 2 * lap_s(); time_s += 0.9) {
    const DepthImage depth = room.render(camera, at(time_s)).depth;
    const auto near = std::count_if(depth.pixels.begin(), depth.pixels.end(),
                                    [](std::uint16_t d) { return d >= 2500 && d <= 20000; });
    EXPECT_GT(near, 80 * 60 * 6 / 10) << "between 0.5 and 4 m, at " << time_s << " s";
    EXPECT_EQ(std::count(depth.pixels.begin(), depth.pixels.end(), 0), 0)
        << "the scene is closed, at " << time_s << " s";
  }
}

INSTANTIATE_TEST_SUITE_P(All, WorldPath,
                         testing::Values(RoomScene::kLoop, RoomScene::kTwins, RoomScene::kOffice,
                                         RoomScene::kBlank),
                         [](const auto& info) { return std::string(name_of(info.param)); });

TEST(WorldPaths, ALapOfTheLoopTakesAboutFiftySeconds) {
  EXPECT_NEAR(world_lap_s(RoomScene::kLoop), 50, 3);
  double length_m = 0;
  for (int i = 0; i < 1000; ++i)
    length_m += (world_pose(RoomScene::kLoop, (i + 1) / 1000.0).translation -
                 world_pose(RoomScene::kLoop, i / 1000.0).translation)
                    .norm();
  EXPECT_NEAR(length_m, 20, 1);
}

}  // namespace
}  // namespace hermite::synthetic::world_paths_test
