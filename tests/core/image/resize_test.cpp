#include "core/image/resize.h"

#include <gtest/gtest.h>

namespace hermite::image {
namespace {

// Linear in x: stays so, with pixel u at (u + 0.5) * ratio - 0.5.
TEST(Resize, KeepsPlacesOfARamp) {
  ColorImage ramp(120, 9);
  for (int y = 0; y < ramp.height; ++y)
    for (int x = 0; x < ramp.width; ++x)
      ramp.at(x, y) = {static_cast<std::uint8_t>(2 * x), static_cast<std::uint8_t>(20 * y), 7};
  for (const ImageSize size :
       {ImageSize{60, 3}, ImageSize{48, 9}, ImageSize{120, 9}, ImageSize{7, 2}}) {
    const ColorImage small = resize_color(ramp, size);
    ASSERT_EQ(small.width, size.width);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        EXPECT_NEAR(small.at(x, y).r, 2 * ((x + 0.5) * 120 / size.width - 0.5), 0.51)
            << x << " of " << size.width;
        // A part of a pixel is flat.
        EXPECT_NEAR(small.at(x, y).g, 20 * ((y + 0.5) * 9 / size.height - 0.5), 1.01);
        EXPECT_EQ(small.at(x, y).b, 7);
      }
  }
  EXPECT_EQ(resize_color(ramp, {120, 9}), ramp);
}

}  // namespace
}  // namespace hermite::image
