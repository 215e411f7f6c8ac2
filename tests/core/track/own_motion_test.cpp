#include "core/track/own_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::track::own_motion_test {
namespace {

constexpr shared::Intrinsics kCamera{65.6f, 65.6f, 39.5f, 29.5f, 80, 60};

// A room 4 m deep and 5 m wide with a papered wall, and an upright board `width_m` wide and 1.7 m
// from the world's origin, seen from `world_from_camera`; the board is where it would be if the
// camera were at `world_from_holder`.
frame::CoarseView seen_from(const Rigid3& world_from_camera, const Rigid3& world_from_holder,
                            double width_m = 0.7) {
  const std::size_t pixels = std::size_t{kCamera.width} * kCamera.height;
  frame::CoarseView view{kCamera, std::vector<float>(pixels), std::vector<Eigen::Vector3f>(pixels),
                         std::vector<float>(pixels)};
  struct Plane {
    Eigen::Vector3d normal;
    double offset_m;
  };
  const std::vector<Plane> walls{{Eigen::Vector3d::UnitZ(), 4},
                                 {Eigen::Vector3d::UnitX(), 2.5},
                                 {-Eigen::Vector3d::UnitX(), 2.5},
                                 {Eigen::Vector3d::UnitY(), 1.2}};
  const Rigid3 holder_from_camera = inverse(world_from_holder) * world_from_camera;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const Eigen::Vector3d ray((x - 39.5) / 65.6, (y - 29.5) / 65.6, 1),
          direction = world_from_camera.rotation * ray;
      double depth_m = 1e9;
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      for (const Plane& wall : walls) {
        const double rate = wall.normal.dot(direction),
                     to_m = (wall.offset_m - wall.normal.dot(world_from_camera.translation)) / rate;
        if (rate > 0 && to_m < depth_m) depth_m = to_m, normal = wall.normal;
      }
      const std::size_t i = view.index(x, y);
      const Eigen::Vector3d place = world_from_camera * (depth_m * ray);
      view.grey[i] = static_cast<float>(120 + 40 * std::sin(5 * place.x() + place.z()) *
                                                  std::sin(4 * place.y() - 2 * place.z()));
      const double board_m =
          (1.7 - holder_from_camera.translation.z()) / (holder_from_camera.rotation * ray).z();
      const Eigen::Vector3d on_board = holder_from_camera * (board_m * ray);
      if (board_m > 0 && board_m < depth_m && std::abs(on_board.x()) < width_m / 2) {
        depth_m = board_m;
        normal = world_from_holder.rotation * Eigen::Vector3d::UnitZ();
        view.grey[i] = static_cast<float>(120 + 60 * std::sin(20 * on_board.x()) *
                                                    std::sin(15 * on_board.y()));
      }
      view.depth_m[i] = static_cast<float>(depth_m);
      view.normals[i] = (world_from_camera.rotation.conjugate() * normal).cast<float>();
    }
  return view;
}

Rigid3 moved(double right_m, double yaw_rad) {
  return exp_se3((Vector6d() << right_m, 0, 0.2 * right_m, 0, yaw_rad, 0).finished());
}

std::uint32_t board_of(const ViewSurfaces& surfaces) { return surfaces.of_pixel[30 * 80 + 40]; }

std::vector<bool> none(const ViewSurfaces& surfaces) {
  return std::vector<bool>(surfaces.pixel_count.size(), false);
}

CameraMotion from_rest(const Rigid3& earlier_from_frame) {
  return {earlier_from_frame, Vector6d::Zero(), Vector6d::Zero()};
}

// Tracking has followed the board for half of the way.
TEST(OwnMotion, IsThatOfABoardBornBeforeTheCamera) {
  const Rigid3 now = moved(0.02, 0.01), thought = moved(0.01, 0.005);
  const frame::CoarseView earlier = seen_from({}, {}), frame = seen_from(now, now);
  const ViewSurfaces surfaces = surfaces_of(frame);
  const OwnMotions motions = own_motions(
      frame, surfaces, earlier, {thought, Vector6d::Zero(), log_se3(now)}, {none(surfaces)});
  for (std::uint32_t surface = 1; surface < surfaces.pixel_count.size(); ++surface)
    EXPECT_EQ(motions.of_surface[surface] == OwnMotion::kMoves, surface == board_of(surfaces))
        << surface;
}

TEST(OwnMotion, IsNobodysInAStillRoom) {
  const Rigid3 now = moved(0.05, -0.04);
  const frame::CoarseView earlier = seen_from({}, {}), frame = seen_from(now, {});
  const ViewSurfaces surfaces = surfaces_of(frame);
  std::vector<bool> moved_before = none(surfaces);
  for (const bool before : {false, true}) {  // nor of a board that has come to rest
    moved_before[board_of(surfaces)] = before;
    const OwnMotions motions =
        own_motions(frame, surfaces, earlier, from_rest(moved(0.045, -0.037)), {moved_before});
    for (std::uint32_t surface = 1; surface < surfaces.pixel_count.size(); ++surface)
      EXPECT_NE(motions.of_surface[surface], OwnMotion::kMoves) << surface;
    EXPECT_EQ(motions.of_surface[board_of(surfaces)], OwnMotion::kRests);
    EXPECT_TRUE(motions.pull.isZero()) << motions.pull.transpose();
  }
}

// A board that moves by much less than the camera may be shifted by its shutter. Whatever it is, it
// drags the camera along.
TEST(OwnMotion, ThatIsSmallPullsTheCamera) {
  const Rigid3 now = moved(0.1, 0.02), board = moved(0.02, 0);
  const frame::CoarseView earlier = seen_from({}, {}, 1.2), frame = seen_from(now, board, 1.2);
  const ViewSurfaces surfaces = surfaces_of(frame);
  const OwnMotions motions =
      own_motions(frame, surfaces, earlier, from_rest(now), {none(surfaces)});
  EXPECT_NE(motions.of_surface[board_of(surfaces)], OwnMotion::kMoves);
  EXPECT_GT(motions.pull.x(), 0.002) << "the board moved to the right, so the camera seems to have "
                                        "moved less than it did";
  EXPECT_LT(motions.pull.x(), 0.02);
}

TEST(OwnMotion, IsNotSaidOfMostOfTheView) {
  const Rigid3 now = moved(0.02, 0.01);
  const frame::CoarseView earlier = seen_from({}, {}, 1.9), frame = seen_from(now, now, 1.9);
  const ViewSurfaces surfaces = surfaces_of(frame);
  const OwnMotions motions =
      own_motions(frame, surfaces, earlier, from_rest(now), {none(surfaces)});
  EXPECT_NE(motions.of_surface[board_of(surfaces)], OwnMotion::kMoves);
}

// Surfaces that usually disagree as much are bent by the lens.
TEST(OwnMotion, MustStandOutFromWhatIsUsual) {
  const Rigid3 now = moved(0.02, 0.01);
  const frame::CoarseView earlier = seen_from({}, {}), frame = seen_from(now, now);
  const ViewSurfaces surfaces = surfaces_of(frame);
  const OwnMotions motions =
      own_motions(frame, surfaces, earlier, from_rest(now), {none(surfaces), 1e6});
  EXPECT_NE(motions.of_surface[board_of(surfaces)], OwnMotion::kMoves);
}

TEST(OwnMotion, OfWhatBothHardlySeeIsUnknown) {
  const Rigid3 away = moved(0, 2);
  const frame::CoarseView earlier = seen_from({}, {}), frame = seen_from(away, {});
  const ViewSurfaces surfaces = surfaces_of(frame);
  for (const OwnMotion motion :
       own_motions(frame, surfaces, earlier, from_rest(away), {none(surfaces)}).of_surface)
    EXPECT_EQ(motion, OwnMotion::kUnknown);
}

}  // namespace
}  // namespace hermite::track::own_motion_test
