#include "core/track/corner_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hermite::track::corner_split_test {
namespace {

const Camera kCamera{640, 480, 525, 525, 319.5, 239.5, 5000};
constexpr double kPrecision_px = 0.3;

struct Scene {
  std::vector<FollowedCorner> corners;
  std::size_t of_room = 0;  // the first ones
};

// A wall and the floor before it, and a board 1.7 m away that goes along with the camera; followed
// to a third of the precision.
Scene scene(const Rigid3& earlier_from_frame, int board_columns = 5) {
  Scene result;
  const Rigid3 frame_from_earlier = inverse(earlier_from_frame);
  const auto add = [&](const Eigen::Vector3d& point, const Eigen::Vector3d& now) {
    const double i = static_cast<double>(result.corners.size());
    result.corners.push_back(
        {point, kCamera.project(now) + 0.1 * Eigen::Vector2d(std::sin(7 * i), std::cos(11 * i))});
  };
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 11; ++x) {
      const Eigen::Vector3d ray((x - 5) * 0.11, (y - 3) * 0.13, 1),
          point = std::min(3.0, y > 3 ? 1.1 / ray.y() : 3.0) * ray;
      add(point, frame_from_earlier * point);
    }
  result.of_room = result.corners.size();
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < board_columns; ++x) {
      const Eigen::Vector3d point((x - 2) * 0.1, (y - 4) * 0.12, 1.7 - 0.05 * (x % 2));
      add(point, point);
    }
  return result;
}

Rigid3 moved(double right_m, double yaw_rad) {
  return exp_se3((Vector6d() << right_m, 0, 0.2 * right_m, 0, yaw_rad, 0).finished());
}

// One motion round the board explains both to half a pixel.
TEST(CornerSplit, TellsWhoGoesAlongFromTheRoom) {
  const Rigid3 truth = moved(0.02, 0.02);
  const Scene seen = scene(truth);
  const auto split = split_corners(seen.corners, {}, kCamera, kPrecision_px);
  ASSERT_TRUE(split.has_value());
  for (std::size_t i = 0; i < seen.corners.size(); ++i)
    EXPECT_EQ(split->moves[i] != 0, i >= seen.of_room) << i;
  EXPECT_LT((split->earlier_from_frame.translation - truth.translation).norm(), 0.003);
  EXPECT_GT(split->moving_share, 0.05);
  EXPECT_LT(split->moving_share, 0.3);
  EXPECT_LT(split->deviation_px, 0.15);
}

TEST(CornerSplit, OfAStillSceneIsWhole) {
  for (const Rigid3& truth : {Rigid3{}, moved(0.1, -0.05)}) {
    Scene seen = scene(truth, 0);
    const auto split = split_corners(seen.corners, {}, kCamera, kPrecision_px);
    ASSERT_TRUE(split.has_value());
    EXPECT_EQ(std::count(split->moves.begin(), split->moves.end(), 1), 0);
  }
}

// Corners slide along edges by pixels while the camera moves them by many.
TEST(CornerSplit, DoesNotTakeALittleOfTheWayForAMotion) {
  Scene seen = scene(moved(0.05, 0.05), 0);
  for (std::size_t i = 0; i < seen.corners.size(); i += 10) seen.corners[i].pixel.x() += 4;
  const auto split = split_corners(seen.corners, {}, kCamera, kPrecision_px);
  ASSERT_TRUE(split.has_value());
  EXPECT_GT(split->error_px[0], 3);
  EXPECT_EQ(std::count(split->moves.begin(), split->moves.end(), 1), 0);
}

// Who covers most of the corners is the room, unless he is known to have moved.
TEST(CornerSplit, RemembersWhoMoved) {
  Scene seen = scene(moved(0.02, 0.02), 27);
  const auto forgetful = split_corners(seen.corners, {}, kCamera, kPrecision_px);
  EXPECT_TRUE(!forgetful || forgetful->moves[0] != 0);
  std::vector<std::uint8_t> moved_before(seen.corners.size(), 1);
  std::fill(moved_before.begin(), moved_before.begin() + static_cast<std::ptrdiff_t>(seen.of_room),
            std::uint8_t{0});
  const auto split = split_corners(seen.corners, moved_before, kCamera, kPrecision_px);
  ASSERT_TRUE(split.has_value());
  EXPECT_EQ(split->moves.front(), 0);
  EXPECT_EQ(split->moves.back(), 1);
}

TEST(CornerSplit, NeedsCornersThatAgree) {
  EXPECT_FALSE(split_corners({}, {}, kCamera, kPrecision_px).has_value());
  Scene seen = scene({}, 0);
  EXPECT_FALSE(
      split_corners({seen.corners.begin(), seen.corners.begin() + 11}, {}, kCamera, kPrecision_px)
          .has_value());
  for (std::size_t i = 0; i < seen.corners.size(); ++i)
    seen.corners[i].pixel += 20 * Eigen::Vector2d(std::sin(3.0 * static_cast<double>(i * i)),
                                                  std::cos(5.0 * static_cast<double>(i * i)));
  EXPECT_FALSE(split_corners(seen.corners, {}, kCamera, kPrecision_px).has_value());
}

}  // namespace
}  // namespace hermite::track::corner_split_test
