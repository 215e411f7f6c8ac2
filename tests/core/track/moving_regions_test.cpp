#include "core/track/moving_regions.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/swaying_camera.h"

namespace hermite::track::moving_regions_test {
namespace {

using test::count;
using test::kCoarseCamera;
using test::kCoarsePixels;
using test::swaying_pose;

// A wall 3 m away and, before it, a board of 0.5 m width 1.8 m away whose middle is at `board_x_m`.
frame::CoarseView room(const Rigid3& world_from_camera, double board_x_m, double board_z_m = 1.8) {
  frame::CoarseView view{kCoarseCamera, std::vector<float>(kCoarsePixels),
                         std::vector<Eigen::Vector3f>(kCoarsePixels),
                         std::vector<float>(kCoarsePixels, 100)};
  const auto depth_of_plane = [&](const Eigen::Vector3d& ray, double z_m) {
    return (z_m - world_from_camera.translation.z()) / (world_from_camera.rotation * ray).z();
  };
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const Eigen::Vector3d ray((x - 39.5) / 65.6, (y - 29.5) / 65.6, 1);
      const double board_m = depth_of_plane(ray, board_z_m);
      const bool on_board = std::abs((world_from_camera * (board_m * ray)).x() - board_x_m) < 0.25;
      view.depth_m[view.index(x, y)] =
          static_cast<float>(on_board ? board_m : depth_of_plane(ray, 3));
      view.normals[view.index(x, y)] =
          (world_from_camera.rotation.conjugate() * Eigen::Vector3d::UnitZ()).cast<float>();
    }
  return view;
}

constexpr double kFar_m = 100;  // where no board is seen

// Pixels of the mask that show the board, and those that do not.
std::pair<double, double> share_of_board_and_room(const frame::CoarseMask& mask,
                                                  const frame::CoarseView& view) {
  double board = 0, board_masked = 0, other = 0, other_masked = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const bool on_board = view.depth_m[i] < 2.4f;
    (on_board ? board : other) += 1;
    (on_board ? board_masked : other_masked) += mask[i];
  }
  return {board_masked / std::max(1.0, board), other_masked / other};
}

TEST(MovingRegions, OfAStillRoomAreNone) {
  MovingRegions regions;
  for (int frame = 0; frame < 60; ++frame) {
    const frame::CoarseView view = room(swaying_pose(frame), 0.1);
    const frame::CoarseMask moving =
        regions.contradicted(view, surfaces_of(view), swaying_pose(frame));
    EXPECT_EQ(count(moving), 0u) << frame;
    EXPECT_EQ(count(regions.expected(view)), 0u) << frame;
    regions.remember(view, swaying_pose(frame), moving);
  }
}

TEST(MovingRegions, AreWhereSomebodyCrosses) {
  MovingRegions regions;
  for (int frame = 0; frame < 40; ++frame) {
    const double board_x_m =
        frame < 10 ? kFar_m : -1.2 + 0.05 * (frame - 10) + swaying_pose(frame).translation.x();
    const frame::CoarseView view = room(swaying_pose(frame), board_x_m);
    const frame::CoarseMask moving =
        regions.contradicted(view, surfaces_of(view), swaying_pose(frame));
    const auto [board, rest] = share_of_board_and_room(moving, view);
    if (frame >= 18) {
      EXPECT_GT(board, 0.9) << frame;
      EXPECT_LT(rest, 0.15) << frame;
    }
    // The region is found in the next frame before its pose is known, one coarse pixel around it
    // included.
    regions.remember(view, swaying_pose(frame), moving);
    const frame::CoarseView next = room(swaying_pose(frame + 1), board_x_m + 0.05);
    if (frame >= 18) {
      EXPECT_GT(share_of_board_and_room(regions.expected(next), next).first, 0.9) << frame;
    }
  }
}

TEST(MovingRegions, EndWhenWhatMovedHasRestedForASecond) {
  MovingRegions regions;
  int frame = 0;
  const auto see = [&](double board_x_m) {
    const frame::CoarseView view = room(swaying_pose(frame), board_x_m);
    const frame::CoarseMask moving =
        regions.contradicted(view, surfaces_of(view), swaying_pose(frame));
    regions.remember(view, swaying_pose(frame), moving);
    ++frame;
    return count(moving);
  };
  for (int i = 0; i < 12; ++i) see(kFar_m);
  EXPECT_GT(see(0), 0u) << "it has come";
  for (int i = 0; i < 8; ++i) EXPECT_GT(see(0), 0u) << "and has not been there for long";
  for (int i = 0; i < 40; ++i) see(0);
  EXPECT_EQ(see(0), 0u);
}

TEST(MovingRegions, OfAWrongPoseAreNotBelieved) {
  MovingRegions regions;
  for (int frame = 0; frame < 12; ++frame)
    regions.remember(room(swaying_pose(frame), kFar_m), swaying_pose(frame),
                     frame::CoarseMask(kCoarsePixels, 0));
  const Rigid3 wrong = swaying_pose(12) * exp_se3((Vector6d() << 0, 0, -0.6, 0, 0, 0).finished());
  const frame::CoarseView view = room(swaying_pose(12), kFar_m);
  EXPECT_EQ(count(regions.contradicted(view, surfaces_of(view), wrong)), 0u);
}

TEST(MovingRegions, AreForgottenWithTheirViews) {
  MovingRegions regions;
  for (int frame = 0; frame < 12; ++frame)
    regions.remember(room(swaying_pose(frame), kFar_m), swaying_pose(frame),
                     frame::CoarseMask(kCoarsePixels, 0));
  const frame::CoarseView view = room(swaying_pose(12), 0);
  EXPECT_GT(count(regions.contradicted(view, surfaces_of(view), swaying_pose(12))), 0u);
  regions.forget();
  EXPECT_EQ(count(regions.contradicted(view, surfaces_of(view), swaying_pose(12))), 0u);
}

TEST(MovingRegions, GoOnFromWhatWasSaved) {
  MovingRegions before;
  for (int frame = 0; frame < 12; ++frame)
    before.remember(room(swaying_pose(frame), kFar_m), swaying_pose(frame),
                    frame::CoarseMask(kCoarsePixels, 0));
  ByteWriter bytes;
  before.save(bytes);
  const std::string saved = bytes.take();
  MovingRegions after;
  ByteReader reader(saved);
  after.restore(reader);
  ASSERT_TRUE(reader.status().ok());
  const frame::CoarseView view = room(swaying_pose(12), 0);
  EXPECT_EQ(after.contradicted(view, surfaces_of(view), swaying_pose(12)),
            before.contradicted(view, surfaces_of(view), swaying_pose(12)));
  ByteReader shorter(std::string_view(saved).substr(0, saved.size() - 5));
  after.restore(shorter);
  EXPECT_FALSE(shorter.status().ok());
}

}  // namespace
}  // namespace hermite::track::moving_regions_test
