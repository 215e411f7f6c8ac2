#include "core/frame/color_registration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tests/core/frame/two_lens_world.h"

namespace hermite::frame::color_registration_test {
namespace {

// Like a Kinect's at a quarter of its size, with twice the distance between its lenses.
Camera kinect_like() {
  Camera camera{160, 120, 146, 146, 80, 60, 1000};
  camera.color = ColorCamera{
      131, 132, 79,
      61,  {},  {Eigen::Quaterniond(1, 0.004, -0.004, 0.001).normalized(), {-0.05, 0.002, 0.004}}};
  return camera;
}

ColorImage registered(const Camera& camera, const RgbdFrame& frame) {
  return ColorRegistration(camera).apply(frame.color, frame.depth);
}

// Levels by which colours differ: a point's place and the mix of four pixels are rounded.
constexpr int kRounding = 2;

int difference(Rgb8 a, Rgb8 b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

// The greatest difference from the true colours, away from the square's edge.
int worst_difference(const Camera& camera, const ColorImage& colors, int border_px) {
  int worst = 0;
  for (int y = border_px; y < camera.height - border_px; ++y)
    for (int x = border_px; x < camera.width - border_px; ++x) {
      if (!test::is_inside_a_face(camera, x, y, 2)) continue;
      const Eigen::Vector3d point = test::point_of(camera, x, y);
      const Rgb8 expected =
          test::is_on_square(point) ? test::kSquareColor : test::wall_color(point);
      worst = std::max(worst, difference(colors.at(x, y), expected));
    }
  return worst;
}

TEST(ColorRegistration, EveryPointGetsItsColourAndTheNearOneDoesNotLeak) {
  const Camera camera = kinect_like();
  const RgbdFrame frame = test::two_lens_frame(camera);
  EXPECT_GT(worst_difference(camera, frame.color, 10), 100)
      << "as it arrives, the square is elsewhere";
  // A hidden stretch, 6 pixels of 14 mm, has the colour of its end: 50 levels a metre.
  EXPECT_LE(worst_difference(camera, registered(camera, frame), 0), kRounding + 4);
}

TEST(ColorRegistration, TheOtherSideLeaksNoMore) {
  Camera camera = kinect_like();
  camera.color->color_from_depth.translation.x() = 0.05;
  EXPECT_LE(worst_difference(camera, registered(camera, test::two_lens_frame(camera)), 0),
            kRounding + 4);
}

TEST(ColorRegistration, AFinerColourCameraHidesAsWell) {
  Camera camera = kinect_like();
  camera.color->fx = camera.color->fy = 200;  // depth pixels lie 1.4 of its pixels apart
  const RgbdFrame frame = test::two_lens_frame(camera);
  EXPECT_LE(worst_difference(camera, registered(camera, frame), 35), kRounding + 4);
  EXPECT_EQ(registered(camera, frame).at(0, 0), frame.color.at(0, 0)) << "the border continues";
  EXPECT_EQ(registered(camera, frame).at(159, 119), frame.color.pixels.back());
}

TEST(ColorRegistration, HolesInASurfaceAreTakenForThatSurface) {
  const Camera camera = kinect_like();
  RgbdFrame frame = test::two_lens_frame(camera);
  for (int y = 8; y < 20; ++y)
    for (int x = 20; x < 60; ++x) frame.depth.at(x, y) = 0;
  for (int y = 58; y < 62; ++y)
    for (int x = 78; x < 82; ++x) frame.depth.at(x, y) = 0;
  EXPECT_LE(worst_difference(camera, registered(camera, frame), 0), kRounding + 4);
}

TEST(ColorRegistration, AHoleBetweenNearAndFarIsTakenForFar) {
  const Camera camera = kinect_like();
  RgbdFrame frame = test::two_lens_frame(camera);
  const ColorImage whole = registered(camera, frame);
  // The shadow of the square: what lies beside it up to a multiple of 16, so that no block around
  // it has only the square.
  int beside = 0;
  for (int y = 48; y < 64; ++y)
    for (int x = 96; x < 128; ++x) {
      if (test::is_on_square(test::point_of(camera, x, y))) continue;
      frame.depth.at(x, y) = x < 120 ? std::uint16_t{0} : frame.depth.at(x, y);
      ++beside;
    }
  ASSERT_GT(beside, 100);
  const ColorImage shadowed = registered(camera, frame);
  for (int y = 48; y < 64; ++y)
    for (int x = 112; x < 120; ++x)
      EXPECT_LE(difference(shadowed.at(x, y), whole.at(x, y)), kRounding) << x << ", " << y;
}

TEST(ColorRegistration, WithoutAnyDepthEverythingIsFar) {
  const Camera camera = kinect_like();
  RgbdFrame frame = test::two_lens_frame(camera);
  std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), std::uint16_t{0});
  const ColorImage far = registered(camera, frame);
  Camera together = camera;
  together.color->color_from_depth.translation.setZero();
  EXPECT_EQ(far, registered(together, frame));
  EXPECT_NE(far.at(80, 60), Rgb8{});
}

TEST(ColorRegistration, OneLensForBothChangesNothing) {
  Camera camera = kinect_like();
  camera.color = ColorCamera{camera.fx, camera.fy, camera.cx, camera.cy, {}, {}};
  const RgbdFrame frame = test::two_lens_frame(camera);
  const ColorImage same = registered(camera, frame);
  for (int y = 1; y < camera.height - 2; ++y)
    for (int x = 1; x < camera.width - 2; ++x)
      ASSERT_LE(difference(same.at(x, y), frame.color.at(x, y)), 1) << x << ", " << y;
}

TEST(ColorRegistration, TheColourLensIsStraightened) {
  Camera camera = kinect_like();
  const RgbdFrame straight = test::two_lens_frame(camera);
  camera.color->distortion = {.k1 = -0.2, .k2 = 0.05, .p1 = 0.003};
  const RgbdFrame bent = test::two_lens_frame(camera);
  EXPECT_NE(bent.color, straight.color);
  EXPECT_LE(worst_difference(camera, registered(camera, bent), 0), kRounding + 4);
}

}  // namespace
}  // namespace hermite::frame::color_registration_test
