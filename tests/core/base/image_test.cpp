#include "core/base/image.h"

#include <gtest/gtest.h>

namespace hermite {
namespace {

TEST(Image, IsRowMajorAndZeroWhenMade) {
  DepthImage image(4, 3);
  EXPECT_EQ(image.pixels, std::vector<std::uint16_t>(12));
  image.at(1, 2) = 7;
  EXPECT_EQ(image.pixels[9], 7);
  EXPECT_EQ(image.index(3, 0), 3u);
}

TEST(Image, EqualityIsOfSizeAndPixels) {
  ColorImage a(2, 3), b(2, 3);
  EXPECT_EQ(a, b);
  b.at(1, 1) = {1, 2, 3};
  EXPECT_FALSE(a == b);
  EXPECT_FALSE(a == ColorImage(3, 2)) << "as many pixels, another shape";
  EXPECT_EQ(ColorImage(), ColorImage(0, 0));
}

}  // namespace
}  // namespace hermite
