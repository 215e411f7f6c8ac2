#include "core/frame/rectify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/core/frame/two_lens_world.h"

namespace hermite::frame::rectify_test {
namespace {

// What the TUM benchmark gives for its first Kinect, at half the resolution.
const Camera kCamera{320,   240,   258.6, 258.2,
                     159.3, 127.6, 5000,  {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};

// Values that say which pixel they come from.
RgbdFrame telling_frame() {
  RgbdFrame frame{1.5, DepthImage(kCamera.width, kCamera.height),
                  ColorImage(kCamera.width, kCamera.height)};
  for (int y = 0; y < kCamera.height; ++y)
    for (int x = 0; x < kCamera.width; ++x) {
      frame.depth.at(x, y) = static_cast<std::uint16_t>(1000 + 4 * x + 2 * y);
      frame.color.at(x, y) = {static_cast<std::uint8_t>(x / 2), static_cast<std::uint8_t>(y), 7};
    }
  return frame;
}

TEST(Rectify, WithoutDistortionEverythingStays) {
  Camera straight = kCamera;
  straight.distortion = {};
  const RgbdFrame frame = telling_frame(), same = Rectifier(straight).apply(frame);
  EXPECT_EQ(same.timestamp_s, 1.5);
  EXPECT_EQ(same.depth.pixels, frame.depth.pixels);
  EXPECT_EQ(same.color.at(100, 100).r, 50);
}

TEST(Rectify, PixelsComeFromWhereTheLensPutThem) {
  const RgbdFrame frame = telling_frame(), straight = Rectifier(kCamera).apply(frame);
  double farthest_px = 0;
  for (int y = 0; y < kCamera.height; y += 7)
    for (int x = 0; x < kCamera.width; x += 7) {
      const Eigen::Vector2d at =
          kCamera.distortion.apply((x - kCamera.cx) / kCamera.fx, (y - kCamera.cy) / kCamera.fy);
      const double u = at.x() * kCamera.fx + kCamera.cx, v = at.y() * kCamera.fy + kCamera.cy;
      farthest_px = std::max(farthest_px, std::hypot(u - x, v - y));
      const int column = static_cast<int>(std::lround(u)), row = static_cast<int>(std::lround(v));
      const bool inside = column >= 0 && row >= 0 && column < kCamera.width && row < kCamera.height;
      ASSERT_EQ(straight.depth.at(x, y) > 0, inside) << x << ", " << y;
      if (!inside) continue;
      ASSERT_NEAR(straight.depth.at(x, y), 1000 + 4 * u + 2 * v, 3) << "half a pixel";
      if (u < 0 || v < 0 || u >= kCamera.width - 1 || v >= kCamera.height - 1) continue;
      ASSERT_NEAR(straight.depth.at(x, y), 1000 + 4 * u + 2 * v, 0.6) << x << ", " << y;
      ASSERT_NEAR(straight.color.at(x, y).g, v, 0.6) << x << ", " << y;
      ASSERT_NEAR(straight.color.at(x, y).r, u / 2, 1.1) << x << ", " << y;
    }
  EXPECT_GT(farthest_px, 2) << "this lens does something";
  EXPECT_LT(farthest_px, 30);
}

TEST(Rectify, DepthIsCorrected) {
  Camera camera = kCamera;
  camera.distortion = {};
  camera.depth_correction = {-0.02, 0.01};
  RgbdFrame frame = telling_frame();
  frame.depth.at(5, 6) = 0;
  frame.depth.at(7, 6) = 65535;
  const RgbdFrame right = Rectifier(camera).apply(frame);
  for (int y = 0; y < camera.height; y += 7)
    for (int x = 0; x < camera.width; x += 7) {
      const double true_m = camera.depth_correction.true_depth_m(
          frame.depth.at(x, y) / camera.depth_units_per_metre, camera.rho2(x, y));
      ASSERT_NEAR(right.depth.at(x, y), true_m * camera.depth_units_per_metre, 0.5)
          << x << ", " << y;
    }
  EXPECT_EQ(right.depth.at(5, 6), 0);
  camera.depth_correction = {0.02, 0};
  EXPECT_EQ(Rectifier(camera).apply(frame).depth.at(7, 6), 0)
      << "beyond what the sensor's unit can say";
  EXPECT_EQ(right.color, frame.color);
  EXPECT_TRUE(rectifier_of(camera));
  camera.depth_correction = {};
  EXPECT_FALSE(rectifier_of(camera));
}

TEST(Rectify, BeyondTheImageIsNoDepthAndTheColourOfTheBorder) {
  Camera barrel = kCamera;
  barrel.distortion = {0.3, 0, 0, 0, 0};  // looks for its corners outside
  const RgbdFrame straight = Rectifier(barrel).apply(telling_frame());
  EXPECT_EQ(straight.depth.at(0, 0), 0);
  EXPECT_EQ(straight.color.at(0, 0), telling_frame().color.at(0, 0));
  EXPECT_GT(straight.depth.at(160, 120), 0);
}

TEST(Rectify, OnlyWhatArrivesOtherwiseIsRectified) {
  Camera camera{160, 120, 146, 146, 80, 60, 1000};
  EXPECT_FALSE(rectifier_of(camera).has_value());
  EXPECT_TRUE(rectifier_of(kCamera).has_value());
  camera.color = ColorCamera{131, 131, 80, 60, {}, {Eigen::Quaterniond::Identity(), {-0.03, 0, 0}}};
  const auto rectifier = rectifier_of(camera);
  ASSERT_TRUE(rectifier.has_value());
  const RgbdFrame frame = test::two_lens_frame(camera);
  EXPECT_EQ(rectifier->apply(frame).depth, frame.depth) << "depth is straight";
  EXPECT_EQ(rectifier->apply(frame).timestamp_s, frame.timestamp_s);
  EXPECT_NE(rectifier->apply(frame).color, frame.color);
}

// Depth goes by its own lens, colour by its own, and they meet on the surface.
TEST(Rectify, EachImageIsStraightenedByItsOwnLens) {
  Camera camera{160, 120, 146, 146, 80, 60, 1000, {.k1 = 0.2, .k2 = -0.1}};
  camera.color = ColorCamera{
      125, 125, 79, 61, {.k1 = -0.2, .p2 = 0.002}, {Eigen::Quaterniond::Identity(), {-0.05, 0, 0}}};
  const RgbdFrame straight = Rectifier(camera).apply(test::two_lens_frame(camera));
  int compared = 0;
  for (int y = 4; y < camera.height - 4; ++y)
    for (int x = 4; x < camera.width - 4; ++x) {
      if (!test::is_inside_a_face(camera, x, y, 2)) continue;
      const Eigen::Vector3d point = test::point_of(camera, x, y);
      if (straight.depth.at(x, y) == 0) continue;  // beyond the depth image
      ++compared;
      ASSERT_EQ(straight.depth.at(x, y), std::lround(1000 * point.z())) << x << ", " << y;
      const Rgb8 expected =
                     test::is_on_square(point) ? test::kSquareColor : test::wall_color(point),
                 found = straight.color.at(x, y);
      // Two of rounding, four for the stretch that the square hides.
      ASSERT_LE(std::max({std::abs(found.r - expected.r), std::abs(found.g - expected.g),
                          std::abs(found.b - expected.b)}),
                6)
          << x << ", " << y;
    }
  EXPECT_GT(compared, 10000);
}

}  // namespace
}  // namespace hermite::frame::rectify_test
