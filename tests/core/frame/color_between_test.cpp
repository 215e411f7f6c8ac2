#include "core/frame/color_between.h"

#include <gtest/gtest.h>

#include <limits>

namespace hermite::frame::color_between_test {
namespace {

ColorImage four_pixels() {
  ColorImage color(2, 2);
  color.pixels = {{0, 10, 100}, {100, 10, 0}, {200, 30, 0}, {100, 30, 200}};
  return color;
}

TEST(ColorBetween, IsBilinear) {
  const ColorImage color = four_pixels();
  EXPECT_EQ(color_between(color, 0, 0), (Rgb8{0, 10, 100}));
  EXPECT_EQ(color_between(color, 0.25f, 0), (Rgb8{25, 10, 75}));
  EXPECT_EQ(color_between(color, 0, 0.5f), (Rgb8{100, 20, 50}));
  EXPECT_EQ(color_between(color, 0.5f, 0.5f), (Rgb8{100, 20, 75}));
}

TEST(ColorBetween, TheBorderContinues) {
  const ColorImage color = four_pixels();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [x, y] :
       {std::pair{-0.01f, 0.0f}, {0.0f, -0.01f}, {-7.0f, -1e9f}, {nan, 0.0f}, {0.0f, nan}})
    EXPECT_EQ(color_between(color, x, y), color.at(0, 0)) << x << ", " << y;
  for (const auto& [x, y] : {std::pair{1.0f, 1.0f}, {1.5f, 1.0f}, {1e9f, 2.0f}})
    EXPECT_EQ(color_between(color, x, y), color.at(1, 1)) << x << ", " << y;
}

}  // namespace
}  // namespace hermite::frame::color_between_test
