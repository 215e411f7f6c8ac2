#include "core/synthetic/world_plans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/synthetic/synthetic_camera.h"

namespace hermite::synthetic::world_plans_test {
namespace {

using Eigen::Vector3d;

const Camera kCamera{160, 120, 131.25, 131.25, 79.5, 59.5, 5000};
constexpr double kHalfUnit_m = 0.5 / 5000;

class WorldPlan : public testing::TestWithParam<RoomScene> {};

TEST_P(WorldPlan, DepthLiesOnTheSurface) {
  const SyntheticRoom room(GetParam());
  for (const double lap : {0.0, 0.11, 0.27, 0.43, 0.58, 0.74, 0.9, 1.35}) {
    const Rigid3 world_from_camera =
        synthetic_pose(lap * synthetic_lap_s(GetParam()), 1, GetParam());
    const DepthImage depth = room.render(kCamera, world_from_camera).depth;
    double largest_m = 0;
    for (int y = 0; y < kCamera.height; ++y)
      for (int x = 0; x < kCamera.width; ++x) {
        const Vector3d point = kCamera.unproject(x, y, depth.at(x, y) / 5000.0);
        largest_m = std::max(largest_m, room.surface_distance(world_from_camera * point));
      }
    // The rounding of depth, along a ray up to 38 degrees from the axis.
    EXPECT_LT(largest_m, 1.3 * kHalfUnit_m) << lap;
  }
}

TEST_P(WorldPlan, NothingIsNearerThanTheDistanceSays) {
  const SyntheticRoom room(GetParam());
  const Rigid3 pose = synthetic_pose(0.3 * synthetic_lap_s(GetParam()), 1, GetParam());
  const double clearance_m = room.surface_distance(pose.translation);
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(quarter * M_PI / 2, Vector3d::UnitZ()) *
                                    pose.rotation);
    const DepthImage depth = room.render(kCamera, {turned, pose.translation}).depth;
    for (int y = 0; y < kCamera.height; ++y)
      for (int x = 0; x < kCamera.width; ++x)
        ASSERT_GT(kCamera.unproject(x, y, depth.at(x, y) / 5000.0).norm(),
                  clearance_m - 2 * kHalfUnit_m);
  }
}

TEST_P(WorldPlan, IsTheSameEveryTime) {
  const Rigid3 pose = synthetic_pose(3, 1, GetParam());
  const RoomView first = SyntheticRoom(GetParam()).render(kCamera, pose),
                 second = SyntheticRoom(GetParam()).render(kCamera, pose);
  EXPECT_EQ(first.depth, second.depth);
  EXPECT_EQ(first.color, second.color);
}

INSTANTIATE_TEST_SUITE_P(All, WorldPlan,
                         testing::Values(RoomScene::kLoop, RoomScene::kTwins, RoomScene::kOffice,
                                         RoomScene::kBlank, RoomScene::kPoster),
                         [](const auto& info) { return std::string(name_of(info.param)); });

// Mean absolute difference of two images' green.
double difference(const ColorImage& a, const ColorImage& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(a.pixels[i].g - b.pixels[i].g);
  return sum / static_cast<double>(a.pixels.size());
}

Rigid3 turned_round(const Rigid3& pose) {
  const Eigen::Quaterniond half_turn(0, 0, 0, 1);
  return {half_turn * pose.rotation, half_turn * pose.translation};
}

TEST(TwinRooms, LookTheSameFromCorrespondingPlaces) {
  const SyntheticRoom room(RoomScene::kTwins);
  for (const double lap : {0.13, 0.17, 0.21, 0.25, 0.29}) {
    const Rigid3 here =
        synthetic_pose(lap * synthetic_lap_s(RoomScene::kTwins), 1, RoomScene::kTwins);
    ASSERT_LT(here.translation.x(), -2.1) << "inside the western room";
    const RoomView view = room.render(kCamera, here),
                   twin = room.render(kCamera, turned_round(here));
    EXPECT_LT(difference(view.color, twin.color), 0.05)
        << "of 255: rounding in the copy's world coordinates, lap " << lap;
    int different_count = 0;
    for (std::size_t i = 0; i < view.depth.pixels.size(); ++i)
      different_count += std::abs(view.depth.pixels[i] - twin.depth.pixels[i]) > 1;
    EXPECT_LE(different_count, 2) << "rays that graze an edge, lap " << lap;
  }
}

TEST(TwinRooms, ThePassageTellsThemApart) {
  const SyntheticRoom room(RoomScene::kTwins);
  const Rigid3 here = synthetic_pose(0, 1, RoomScene::kTwins);
  EXPECT_GT(
      difference(room.render(kCamera, here).color, room.render(kCamera, turned_round(here)).color),
      10);
}

TEST(Office, LooksTheSameOneBayFurther) {
  const SyntheticRoom room(RoomScene::kOffice);
  Eigen::Matrix3d down_north;  // towards +y, 40 degrees down: a desk and nothing behind the row
  const double pitch = -40 * M_PI / 180;
  const Vector3d forward(0, std::cos(pitch), std::sin(pitch)), right(1, 0, 0);
  down_north << right, forward.cross(right), forward;
  const auto view_at = [&](double x) {
    return room.render(kCamera, {Eigen::Quaterniond(down_north), {x, -1.5, 1.35}});
  };
  const RoomView first = view_at(-0.95), second = view_at(0.95);
  EXPECT_GT(std::count(first.depth.pixels.begin(), first.depth.pixels.end(), first.depth.pixels[0]),
            0);
  int same_count = 0;
  for (std::size_t i = 0; i < first.depth.pixels.size(); ++i)
    same_count += std::abs(first.depth.pixels[i] - second.depth.pixels[i]) <= 1;
  EXPECT_GT(same_count, kCamera.width * kCamera.height * 9 / 10)
      << "but for what stands on one desk only";
}

TEST(Blank, HasLessToSeeThanTheFurnishedRoom) {
  const auto mean_gradient = [](RoomScene scene) {
    const SyntheticRoom room(scene);
    double sum = 0;
    for (const double lap : {0.1, 0.35, 0.6, 0.85}) {
      const ColorImage color =
          room.render(kCamera, synthetic_pose(lap * synthetic_lap_s(scene), 1, scene)).color;
      for (std::size_t i = 1; i < color.pixels.size(); ++i)
        sum += std::abs(color.pixels[i].g - color.pixels[i - 1].g);
    }
    return sum;
  };
  EXPECT_LT(mean_gradient(RoomScene::kBlank), 0.3 * mean_gradient(RoomScene::kRoom));
}

}  // namespace
}  // namespace hermite::synthetic::world_plans_test
