#include "core/math/depth_between.h"

#include <gtest/gtest.h>

namespace hermite::depth_between_test {
namespace {

// A plane: its inverse depth is linear over the image.
DepthImage slope() {
  DepthImage depth(20, 10);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      depth.at(x, y) = static_cast<std::uint16_t>(std::lround(20000 / (4 + 0.02 * x + 0.01 * y)));
  return depth;
}

TEST(DepthBetween, IsThePlanesOwn) {
  const DepthImage depth = slope();
  EXPECT_EQ(depth_between(depth, 7, 3), depth.at(7, 3));
  for (const auto& [x, y] : {std::pair{7.5, 3.0}, {7.0, 3.25}, {7.3, 3.9}, {18.9, 8.9}})
    EXPECT_NEAR(depth_between(depth, x, y), 20000 / (4 + 0.02 * x + 0.01 * y), 1) << x << ", " << y;
}

TEST(DepthBetween, IsOfOneSurfaceOrTheOther) {
  DepthImage depth(20, 10);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) depth.at(x, y) = x < 10 ? 1000 : 1200;
  EXPECT_EQ(depth_between(depth, 9.4, 5.5), 1000);
  EXPECT_EQ(depth_between(depth, 9.6, 5.5), 1200);
  depth.at(4, 4) = 0;
  EXPECT_EQ(depth_between(depth, 4.4, 4.4), 0) << "a hole stays";
  EXPECT_EQ(depth_between(depth, 4.6, 4.4), 1000);
}

TEST(DepthBetween, EndsWithTheImage) {
  const DepthImage depth = slope();
  EXPECT_EQ(depth_between(depth, -0.4, 9.4), depth.at(0, 9)) << "half of a pixel is inside";
  for (const auto& [x, y] : {std::pair{-0.6, 5.0}, {19.6, 5.0}, {5.0, -0.6}, {5.0, 9.6}})
    EXPECT_EQ(depth_between(depth, x, y), 0) << x << ", " << y;
}

}  // namespace
}  // namespace hermite::depth_between_test
