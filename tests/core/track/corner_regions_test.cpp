#include "core/track/corner_regions.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace hermite::track::corner_regions_test {
namespace {

constexpr shared::Intrinsics kCamera{65.6f, 65.6f, 39.5f, 29.5f, 80, 60};

// A wall 3 m away and before it a board at x of 30 to 49 pixels, 1.5 m away.
frame::CoarseView board_before_wall() {
  frame::CoarseView view{kCamera, std::vector<float>(4800, 3),
                         std::vector<Eigen::Vector3f>(4800, Eigen::Vector3f::UnitZ()),
                         std::vector<float>(4800, 100)};
  for (int y = 0; y < 60; ++y)
    for (int x = 30; x < 50; ++x) view.depth_m[view.index(x, y)] = 1.5f;
  return view;
}

// One in 4x4 coarse pixels from x of `from` to `to`, in pixels of an image of 640.
void add(std::vector<SeenCorner>& corners, int from, int to, bool moves) {
  for (int y = 2; y < 60; y += 4)
    for (int x = from; x < to; x += 4)
      corners.push_back({Eigen::Vector2d(8 * x + 3.5, 8 * y + 3.5), moves});
}

std::size_t masked(const frame::CoarseView& view, const frame::CoarseMask& mask, int from, int to) {
  std::size_t count = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = from; x < to; ++x) count += mask[view.index(x, y)];
  return count;
}

TEST(CornerRegions, EndWhereTheSurfaceDoes) {
  const frame::CoarseView view = board_before_wall();
  std::vector<SeenCorner> corners;
  add(corners, 31, 49, true);
  add(corners, 2, 28, false);
  add(corners, 52, 78, false);
  const frame::CoarseMask mask = regions_of_corners(view, surfaces_of(view), corners, 640);
  EXPECT_EQ(masked(view, mask, 30, 50), 1200u);
  EXPECT_EQ(masked(view, mask, 0, 80), 1200u);
}

// A plate that turns on a table is one surface with it.
TEST(CornerRegions, AreNotAllOfASurfaceWithoutCorners) {
  const frame::CoarseView view = board_before_wall();
  std::vector<SeenCorner> corners;
  add(corners, 2, 12, true);
  const frame::CoarseMask mask = regions_of_corners(view, surfaces_of(view), corners, 640);
  EXPECT_GT(masked(view, mask, 0, 12), 600u);
  EXPECT_EQ(masked(view, mask, 24, 80), 0u);
}

TEST(CornerRegions, NeedMoreThanOneCorner) {
  const frame::CoarseView view = board_before_wall();
  std::vector<SeenCorner> corners{{Eigen::Vector2d(320, 240), true}};
  EXPECT_EQ(masked(view, regions_of_corners(view, surfaces_of(view), corners, 640), 0, 80), 0u);
  EXPECT_EQ(masked(view, regions_of_corners(view, surfaces_of(view), {}, 640), 0, 80), 0u);
}

TEST(CornerRegions, OfCornersOutsideAreNone) {
  const frame::CoarseView view = board_before_wall();
  std::vector<SeenCorner> corners(9, {Eigen::Vector2d(-50, 700), true});
  EXPECT_EQ(masked(view, regions_of_corners(view, surfaces_of(view), corners, 640), 0, 80), 0u);
}

}  // namespace
}  // namespace hermite::track::corner_regions_test
