// Pixels in memory: row major, no padding, (0, 0) is the centre of the top left pixel. Plain
// values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hermite {

template <class Pixel>
struct Image {
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::vector<Pixel> pixels;

  Image() = default;
  Image(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  Pixel& at(int x, int y) { return pixels[index(x, y)]; }
  const Pixel& at(int x, int y) const { return pixels[index(x, y)]; }
  bool operator==(const Image&) const = default;
};

struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb8&) const = default;
};
static_assert(sizeof(Rgb8) == 3, "decoders write packed RGB");

using DepthImage = Image<std::uint16_t>;  // sensor units, 0 = no measurement
using ColorImage = Image<Rgb8>;           // sRGB

}  // namespace hermite
