#include "core/frame/retime.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/support/gpu_test.h"

namespace hermite::frame::retime_test {
namespace {

constexpr double kUnits = 5000;

Camera camera_with(const ImageTiming& timing) {
  Camera camera{320, 240, 262, 262, 159.5, 119.5, kUnits};
  camera.timing = timing;
  return camera;
}

// A hand that turns and walks fast: the image moves by 12 pixels while it is read out in 30 ms.
const Vector6d kTwist_per_s = (Vector6d() << 0.5, -0.3, 0.4, 0.9, -1.2, 0.7).finished();

// A tilted wall with soft stripes, and a post before it.
struct Sight {
  double depth_m = 0;
  Rgb8 color;
};
Sight sight(const Rigid3& stamp_from_row, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d direction = stamp_from_row.rotation * ray;
  const auto behind = [&](const Eigen::Vector3d& normal, double offset_m) {
    return (offset_m - normal.dot(stamp_from_row.translation)) / normal.dot(direction);
  };
  const double post_m = behind({0, 0, 1}, 1.2),
               wall_m = behind(Eigen::Vector3d(0.3, 0.4, 1).normalized(), 2.5);
  const Eigen::Vector3d on_post = stamp_from_row * Eigen::Vector3d(post_m * ray);
  const bool is_post = std::abs(on_post.x() - 0.2) < 0.08;
  const Eigen::Vector3d point = is_post ? on_post : stamp_from_row * Eigen::Vector3d(wall_m * ray);
  const auto grey = [](double value) {
    return static_cast<std::uint8_t>(std::lround(128 + 100 * std::sin(value)));
  };
  return {is_post ? post_m : wall_m,
          {grey(8 * point.x()), grey(8 * point.y()), grey(6 * (point.x() + point.z()))}};
}

// The frame that the moving camera takes.
RgbdFrame taken(const Camera& camera, const Vector6d& twist_per_s) {
  RgbdFrame frame{1.5, DepthImage(camera.width, camera.height),
                  ColorImage(camera.width, camera.height)};
  for (int y = 0; y < camera.height; ++y) {
    const Rigid3 stamp_from_depth =
        exp_se3(camera.timing.depth_time_s(y, camera.height) * twist_per_s);
    const Rigid3 stamp_from_color =
        exp_se3(camera.timing.color_time_s(y, camera.height) * twist_per_s);
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.unproject(x, y, 1);
      frame.depth.at(x, y) =
          static_cast<std::uint16_t>(std::lround(kUnits * sight(stamp_from_depth, ray).depth_m));
      frame.color.at(x, y) = sight(stamp_from_color, ray).color;
    }
  }
  return frame;
}

// The differences that 95 and 99.5 % of the pixels do not exceed, without those that the taken
// frame does not show; the rest is behind the post.
struct Difference {
  int usual = 0, most = 0;
};
template <class Image, class Value>
Difference difference(const Image& a, const Image& b, const Value& value) {
  constexpr int kBorder_px = 10;
  std::vector<int> all;
  for (int y = kBorder_px; y < a.height - kBorder_px; ++y)
    for (int x = kBorder_px; x < a.width - kBorder_px; ++x)
      all.push_back(std::abs(value(a.at(x, y)) - value(b.at(x, y))));
  std::ranges::sort(all);
  return {all[all.size() * 95 / 100], all[all.size() * 995 / 1000]};
}
const auto kDepth = [](std::uint16_t units) { return int{units}; };
const auto kGreen = [](const Rgb8& color) { return int{color.g}; };

class RetimeTest : public test::GpuTest {};

TEST_F(RetimeTest, UndoesARollingShutterAndLateColour) {
  const Camera camera = camera_with({0.030, 0.024, 0.010});
  const RgbdFrame truth = taken(rectified(camera), kTwist_per_s),
                  rolling = taken(camera, kTwist_per_s);
  const RgbdFrame corrected = Retimer(device(), camera).apply(rolling, kTwist_per_s);
  EXPECT_EQ(corrected.timestamp_s, 1.5);
  EXPECT_GT(difference(rolling.depth, truth.depth, kDepth).usual, 0.010 * kUnits);
  EXPECT_LE(difference(corrected.depth, truth.depth, kDepth).usual, 0.0004 * kUnits);
  EXPECT_GT(difference(rolling.color, truth.color, kGreen).usual, 20);
  EXPECT_LE(difference(corrected.color, truth.color, kGreen).usual, 2);
  EXPECT_LE(difference(corrected.color, truth.color, kGreen).most, 12);
}

TEST_F(RetimeTest, UndoesAShutterThatRunsUpwards) {
  const Camera camera = camera_with({-0.030, -0.030, 0});
  const RgbdFrame corrected =
      Retimer(device(), camera).apply(taken(camera, kTwist_per_s), kTwist_per_s);
  EXPECT_LE(difference(corrected.depth, taken(rectified(camera), kTwist_per_s).depth, kDepth).usual,
            0.0004 * kUnits);
}

TEST_F(RetimeTest, ACameraAtRestShowsTheSame) {
  const Camera camera = camera_with({0.030, 0.030, 0.010});
  const RgbdFrame frame = taken(camera, Vector6d::Zero()),
                  same = Retimer(device(), camera).apply(frame, Vector6d::Zero());
  EXPECT_EQ(same.depth, frame.depth);
  EXPECT_LE(difference(same.color, frame.color, kGreen).most, 0);
}

TEST_F(RetimeTest, LateColourLeavesDepthAsItIs) {
  const Camera camera = camera_with({0, 0, 0.010});
  const RgbdFrame frame = taken(camera, kTwist_per_s);
  EXPECT_EQ(Retimer(device(), camera).apply(frame, kTwist_per_s).depth, frame.depth);
}

// Nor is depth made up where there is none.
TEST_F(RetimeTest, AFrameWithoutDepthHasColourAtInfinity) {
  const Camera camera = camera_with({0.030, 0.030, 0});
  RgbdFrame frame = taken(camera, kTwist_per_s);
  std::ranges::fill(frame.depth.pixels, std::uint16_t{0});
  const RgbdFrame corrected = Retimer(device(), camera).apply(frame, kTwist_per_s);
  EXPECT_EQ(std::ranges::count(corrected.depth.pixels, 0), std::ssize(frame.depth.pixels));
  EXPECT_NE(corrected.color, frame.color);
}

TEST(Retiming, MovesAPixelToTheTimeStamp) {
  const Camera camera = camera_with({0, 0.030, 0.010});
  const Eigen::Vector3d point_m(0.5, -0.4, 2);
  Eigen::Vector2d seen_px = camera.project(point_m);
  for (int round = 0; round < 20; ++round)
    seen_px = camera.project(
        exp_se3(-camera.timing.color_time_s(seen_px.y(), camera.height) * kTwist_per_s) * point_m);
  const Eigen::Vector2d corrected_px = color_pixel_at_stamp(camera, seen_px, point_m, kTwist_per_s);
  EXPECT_GT((seen_px - camera.project(point_m)).norm(), 1);
  EXPECT_LT((corrected_px - camera.project(point_m)).norm(), 1e-6);
  const Eigen::Vector3d behind_m(0, 0, -1);
  EXPECT_EQ(color_pixel_at_stamp(camera, seen_px, behind_m, kTwist_per_s), seen_px);
}

TEST(Retiming, SaysHowMuchAnotherTwistWouldChange) {
  const Camera camera = camera_with({0.030, 0.030, 0});
  DepthImage wall(camera.width, camera.height);
  EXPECT_EQ(retiming_difference_m(camera, wall, kTwist_per_s, Vector6d::Zero()), 0)
      << "nothing is seen";
  for (std::uint16_t& units : wall.pixels) units = 10000;
  EXPECT_EQ(retiming_difference_m(camera, wall, kTwist_per_s, kTwist_per_s), 0);
  // Rows are evenly spread over the readout, which gives 1 / sqrt(12) of it.
  Vector6d sideways = kTwist_per_s;
  sideways.x() += 0.1;
  EXPECT_NEAR(retiming_difference_m(camera, wall, kTwist_per_s, sideways),
              0.1 * camera.timing.depth_readout_s / std::sqrt(12), 1e-4);
}

}  // namespace
}  // namespace hermite::frame::retime_test
