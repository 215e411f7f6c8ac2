#include "core/frame/rectify.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite {
namespace {

// What the TUM benchmark gives for its first Kinect, at half the resolution.
constexpr Camera kCamera{320, 240, 258.6, 258.2, 159.3, 127.6, 5000, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};

// Values that say which pixel they come from.
RgbdFrame telling_frame() {
  RgbdFrame frame{1.5, DepthImage(kCamera.width, kCamera.height), ColorImage(kCamera.width, kCamera.height)};
  for (int y = 0; y < kCamera.height; ++y)
    for (int x = 0; x < kCamera.width; ++x) {
      frame.depth.at(x, y) = static_cast<std::uint16_t>(1 + y * kCamera.width % 60000 / 2 + x);
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
      const Eigen::Vector2d at = kCamera.distortion.apply((x - kCamera.cx) / kCamera.fx, (y - kCamera.cy) / kCamera.fy);
      const double u = at.x() * kCamera.fx + kCamera.cx, v = at.y() * kCamera.fy + kCamera.cy;
      farthest_px = std::max(farthest_px, std::hypot(u - x, v - y));
      const int column = static_cast<int>(std::lround(u)), row = static_cast<int>(std::lround(v));
      const bool inside = column >= 0 && row >= 0 && column < kCamera.width && row < kCamera.height;
      ASSERT_EQ(straight.depth.at(x, y), inside ? frame.depth.at(column, row) : 0) << x << ", " << y;
      if (u < 0 || v < 0 || u >= kCamera.width - 1 || v >= kCamera.height - 1) continue;
      ASSERT_NEAR(straight.color.at(x, y).g, v, 0.6) << x << ", " << y;
      ASSERT_NEAR(straight.color.at(x, y).r, u / 2, 1.1) << x << ", " << y;
    }
  EXPECT_GT(farthest_px, 2) << "this lens does something";
  EXPECT_LT(farthest_px, 30);
}

TEST(Rectify, BeyondTheImageIsNothing) {
  Camera barrel = kCamera;
  barrel.distortion = {0.3, 0, 0, 0, 0};  // looks for its corners outside
  const RgbdFrame straight = Rectifier(barrel).apply(telling_frame());
  EXPECT_EQ(straight.depth.at(0, 0), 0);
  EXPECT_EQ(straight.color.at(0, 0).b, 0);
  EXPECT_GT(straight.depth.at(160, 120), 0);
}

}  // namespace
}  // namespace hermite
