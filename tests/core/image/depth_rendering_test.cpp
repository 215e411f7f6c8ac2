#include "core/image/depth_rendering.h"

#include <gtest/gtest.h>

namespace hermite::image {
namespace depth_rendering_test {

// 1000 to 1199, and as many pixels without depth.
DepthImage ramp() {
  DepthImage depth(200, 2);
  for (int x = 0; x < 200; ++x) depth.at(x, 0) = static_cast<std::uint16_t>(1000 + x);
  return depth;
}

TEST(DepthRendering, TheExtentLeavesOutTheLastHundredthAtEitherEnd) {
  const DepthExtent extent = extent_of(ramp());
  EXPECT_EQ(extent.range.nearest, 1002);
  EXPECT_EQ(extent.range.farthest, 1197);
  EXPECT_EQ(extent.valid_share, 0.5);
}

TEST(DepthRendering, WhereNothingOrAllTheSameWasMeasuredThereIsAnExtentToo) {
  const DepthExtent nothing = extent_of(DepthImage(3, 2));
  EXPECT_EQ(nothing.range.nearest, 0);
  EXPECT_EQ(nothing.range.farthest, 0);
  EXPECT_EQ(nothing.valid_share, 0);
  DepthImage one(3, 2);
  one.at(1, 1) = 65535;
  EXPECT_EQ(extent_of(one).range.nearest, 65535);
  EXPECT_EQ(extent_of(one).range.farthest, 65535);
  EXPECT_NE(depth_rendering(one, extent_of(one).range).at(1, 1), Rgb8());
}

TEST(DepthRendering, NearIsRedFarIsBlueAndNothingIsBlack) {
  const ColorImage rendering = depth_rendering(ramp(), {1000, 1199});
  const Rgb8 near = rendering.at(0, 0), middle = rendering.at(100, 0), far = rendering.at(199, 0);
  EXPECT_GT(near.r, 100);
  EXPECT_LT(near.g + near.b, 40);
  EXPECT_GT(middle.g, 200);
  EXPECT_LT(far.r, 70);
  EXPECT_GT(far.b, far.g);
  EXPECT_EQ(rendering.at(0, 1), Rgb8());
  const ColorImage narrow = depth_rendering(ramp(), {1050, 1100});
  EXPECT_EQ(narrow.at(0, 0), near) << "what is nearer than the range is as its end";
  EXPECT_EQ(narrow.at(199, 0), far);
}

}  // namespace depth_rendering_test
}  // namespace hermite::image
