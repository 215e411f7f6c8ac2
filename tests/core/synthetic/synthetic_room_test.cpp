#include "core/synthetic/synthetic_room.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/synthetic/synthetic_camera.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

const Camera kCamera{320, 240, 262.5, 262.5, 159.5, 119.5, 5000};
constexpr double kHalfUnit_m = 0.5 / 5000;

const SyntheticRoom& room() {
  static const SyntheticRoom shared(RoomScene::kRoom);
  return shared;
}

Rigid3 pose_at(double lap) { return synthetic_pose(10 * lap, 1); }

TEST(SyntheticRoom, DepthLiesOnTheSurface) {
  for (const double lap : {0.0, 0.13, 0.31, 0.5, 0.77, 1.4}) {
    const Rigid3 world_from_camera = pose_at(lap);
    const RoomView view = room().render(kCamera, world_from_camera);
    double largest_m = 0;
    for (int y = 0; y < kCamera.height; ++y)
      for (int x = 0; x < kCamera.width; ++x) {
        ASSERT_GT(view.depth.at(x, y), 0) << "the room is closed";
        const Vector3d point = kCamera.unproject(x, y, view.depth.at(x, y) / 5000.0);
        largest_m = std::max(largest_m, room().surface_distance(world_from_camera * point));
      }
    // The rounding of depth, along a ray up to 38 degrees from the axis.
    EXPECT_LT(largest_m, 1.3 * kHalfUnit_m) << lap;
  }
}

// A point seen by one camera is, from another, where it projects to, or hidden behind something
// nearer; never in front of what is seen.
TEST(SyntheticRoom, TwoViewsAgree) {
  const Rigid3 world_from_a = pose_at(0.20), world_from_b = pose_at(0.215);
  const RoomView a = room().render(kCamera, world_from_a), b = room().render(kCamera, world_from_b);
  const Rigid3 b_from_a = inverse(world_from_b) * world_from_a;
  int compared = 0, agreeing = 0, in_front = 0;
  double color_difference = 0;
  for (int y = 0; y < kCamera.height; ++y)
    for (int x = 0; x < kCamera.width; ++x) {
      const Vector3d in_b = b_from_a * kCamera.unproject(x, y, a.depth.at(x, y) / 5000.0);
      const Eigen::Vector2d pixel = kCamera.project(in_b);
      const int u = static_cast<int>(std::lround(pixel.x())),
                v = static_cast<int>(std::lround(pixel.y()));
      if (u < 1 || v < 1 || u >= kCamera.width - 1 || v >= kCamera.height - 1) continue;
      ++compared;
      double nearest_m = 1e9, smallest_m = 1e9;
      for (int dv = -1; dv <= 1; ++dv)
        for (int du = -1; du <= 1; ++du) {
          nearest_m = std::min(nearest_m, std::abs(b.depth.at(u + du, v + dv) / 5000.0 - in_b.z()));
          smallest_m = std::min(smallest_m, in_b.z() - b.depth.at(u + du, v + dv) / 5000.0);
        }
      if (smallest_m < -0.05) {
        bool all_behind = true;
        for (int dv = -1; dv <= 1; ++dv)
          for (int du = -1; du <= 1; ++du)
            all_behind = all_behind && b.depth.at(u + du, v + dv) / 5000.0 > in_b.z() + 0.05;
        in_front += all_behind ? 1 : 0;
      }
      if (nearest_m > 0.02) continue;
      ++agreeing;
      color_difference += std::abs(a.color.at(x, y).g - b.color.at(u, v).g);
    }
  EXPECT_GT(compared, 320 * 240 * 8 / 10);
  EXPECT_GT(agreeing, compared * 97 / 100);
  EXPECT_LT(in_front, compared / 2000)
      << "only bodies thinner than a pixel may vanish between rays";
  EXPECT_LT(color_difference / agreeing, 8)
      << "colours do not depend on the viewer; the rest is resampling";
}

TEST(SyntheticRoom, ABareRoomsDepthIsThatOfItsWalls) {
  const SyntheticRoom bare(RoomScene::kBare);
  // From the middle along +x: the wall is 2.4 m away, everywhere on the optical axis' plane.
  Eigen::Matrix3d rotation;
  rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const RoomView view = bare.render(kCamera, {Eigen::Quaterniond(rotation), {0, 0, 1.3}});
  EXPECT_EQ(view.depth.at(160, 120), 12000);
  EXPECT_EQ(view.depth.at(60, 60), 12000);
  EXPECT_EQ(bare.surface_distance({0, 0, 1.3}), 1.3);
}

TEST(SyntheticRoom, RenderingIsDeterministic) {
  const RoomView first = room().render(kCamera, pose_at(0.4)),
                 second = SyntheticRoom(RoomScene::kRoom).render(kCamera, pose_at(0.4));
  EXPECT_EQ(first.depth, second.depth);
  EXPECT_EQ(first.color, second.color);
}

TEST(SyntheticRoom, SidesThatAreNoMultipleOfATileAreRenderedWhole) {
  const Camera odd{77, 65, 70, 70, 38, 32, 5000};
  const RoomView view = room().render(odd, pose_at(0.1));
  EXPECT_EQ(std::count(view.depth.pixels.begin(), view.depth.pixels.end(), 0), 0);
}

TEST(SyntheticRoom, ImagesHaveDetailAndAreNeitherBlackNorBurnt) {
  for (const double lap : {0.0, 0.25, 0.5, 0.75}) {
    const ColorImage color = room().render(kCamera, pose_at(lap)).color;
    double sum = 0, gradient = 0;
    int burnt = 0;
    for (int y = 0; y < color.height; ++y)
      for (int x = 1; x < color.width; ++x) {
        sum += color.at(x, y).g;
        gradient += std::abs(color.at(x, y).g - color.at(x - 1, y).g);
        burnt += color.at(x, y).g == 255 ? 1 : 0;
      }
    const double count = 319.0 * 240;
    EXPECT_GT(sum / count, 60);
    EXPECT_LT(sum / count, 190);
    EXPECT_GT(gradient / count, 2);
    EXPECT_LT(burnt, count / 20);
  }
}

}  // namespace
}  // namespace hermite::synthetic
