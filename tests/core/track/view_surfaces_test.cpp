#include "core/track/view_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace hermite::track::view_surfaces_test {
namespace {

constexpr shared::Intrinsics kCamera{65.6f, 65.6f, 39.5f, 29.5f, 80, 60};

// A wall at 4 m, a floor 1.2 m below the camera, and a board at 1.7 m before the middle of both.
frame::CoarseView view_of_a_board() {
  const std::size_t pixels = std::size_t{kCamera.width} * kCamera.height;
  frame::CoarseView view{kCamera, std::vector<float>(pixels),
                         std::vector<Eigen::Vector3f>(pixels, Eigen::Vector3f::UnitZ()),
                         std::vector<float>(pixels)};
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const float down = (static_cast<float>(y) - kCamera.cy) / kCamera.fy,
                  across = (static_cast<float>(x) - kCamera.cx) / kCamera.fx;
      const std::size_t i = view.index(x, y);
      view.depth_m[i] = std::abs(across) < 0.2f ? 1.7f : 4.0f;
      if (down > 0 && 1.2f / down < view.depth_m[i]) {
        view.depth_m[i] = 1.2f / down;
        view.normals[i] = Eigen::Vector3f::UnitY();
      }
    }
  return view;
}

TEST(ViewSurfaces, EndAtStepsAndWhereWallsMeet) {
  const frame::CoarseView view = view_of_a_board();
  const ViewSurfaces surfaces = surfaces_of(view);
  const auto at = [&](int x, int y) { return surfaces.of_pixel[view.index(x, y)]; };
  EXPECT_NE(at(40, 20), at(10, 20)) << "the board and the wall behind it";
  EXPECT_NE(at(10, 20), at(10, 58)) << "the wall and the floor";
  EXPECT_NE(at(10, 20), at(70, 20))
      << "the wall on both sides of the board, which hides what joins them";
  EXPECT_EQ(at(5, 10), at(15, 25));
  EXPECT_NE(at(10, 20), 0u);
  std::size_t pixels = 0;
  for (const std::size_t count : surfaces.pixel_count) pixels += count;
  EXPECT_EQ(pixels, view.size());
}

// Normals are computed over windows of pixels: they turn gradually where surfaces meet.
TEST(ViewSurfaces, EndWhereWallsMeetThoughNormalsTurnGradually) {
  frame::CoarseView view = view_of_a_board();
  const auto normals = view.normals;
  for (int y = 2; y + 2 < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int dy = -2; dy <= 2; ++dy) sum += normals[view.index(x, y + dy)];
      view.normals[view.index(x, y)] = sum.normalized();
    }
  const ViewSurfaces surfaces = surfaces_of(view);
  const auto at = [&](int x, int y) { return surfaces.of_pixel[view.index(x, y)]; };
  EXPECT_NE(at(10, 20), at(10, 58)) << "the wall and the floor";
  EXPECT_NE(at(10, 58), 0u);
  for (int y = 0; y < 60; ++y)
    EXPECT_NE(at(10, y), 0u) << "the edge belongs to one of the two, in row " << y;
}

// Noise of normals does not divide a wall.
TEST(ViewSurfaces, OfANoisyWallAreOne) {
  frame::CoarseView view = view_of_a_board();
  std::fill(view.depth_m.begin(), view.depth_m.end(), 2.0f);
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 0.13f);  // 7.5 degrees
  for (Eigen::Vector3f& normal : view.normals)
    normal = Eigen::Vector3f(noise(random), noise(random), 1).normalized();
  const ViewSurfaces surfaces = surfaces_of(view);
  ASSERT_EQ(surfaces.pixel_count.size(), 2u);
  EXPECT_GT(surfaces.pixel_count[1], 95 * view.size() / 100);
}

TEST(ViewSurfaces, OfNothingOrOfCrumbsAreNone) {
  EXPECT_EQ(surfaces_of(frame::CoarseView{}).pixel_count.size(), 1u);
  frame::CoarseView crumbs = view_of_a_board();
  std::fill(crumbs.depth_m.begin(), crumbs.depth_m.end(), 0.0f);
  for (int i = 0; i < 40; ++i) crumbs.depth_m[crumbs.index(i, 5)] = 2;  // of 4800 pixels
  const ViewSurfaces surfaces = surfaces_of(crumbs);
  EXPECT_EQ(surfaces.pixel_count, std::vector<std::size_t>{crumbs.size()});
  EXPECT_EQ(*std::max_element(surfaces.of_pixel.begin(), surfaces.of_pixel.end()), 0u);
}

}  // namespace
}  // namespace hermite::track::view_surfaces_test
