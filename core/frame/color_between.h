// Bilinear interpolation of colours.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/image.h"

namespace hermite::frame {

// Packs three channels into one number, with eight spare bits each; the lowest bytes of `pixel` are
// red, green and blue.
inline std::uint64_t spread(std::uint32_t pixel) {
  return (pixel & 0xff00ffu) | (std::uint64_t{pixel & 0xff00u} << 24);
}

// Interpolates between two packed colours, with `share` in 256ths.
inline std::uint64_t mix(std::uint64_t a, std::uint64_t b, std::uint64_t share) {
  return ((a * (256 - share) + b * share + 0x8000800080u) >> 8) & 0xff00ff00ffu;
}

// Interpolates between two neighbours in a row.
inline std::uint64_t mix(const Rgb8* pair, std::uint64_t share) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(pair);
  const auto four = [bytes](int first) {
    return std::uint32_t{bytes[first]} | std::uint32_t{bytes[first + 1]} << 8 |
           std::uint32_t{bytes[first + 2]} << 16 | std::uint32_t{bytes[first + 3]} << 24;
  };
  return mix(spread(four(0)), spread(four(2) >> 8), share);
}

// Interpolates bilinearly between the four pixels around (x, y), with positions rounded to a 256th
// of a pixel; the error is at most one level. Outside of the image it continues the border: a black
// margin would stay where it is while the camera moves, and its edge would hold the camera back.
// The image has at least two rows and columns.
inline Rgb8 color_between(const ColorImage& color, float x, float y) {
  constexpr float kLast = 1.0f + 1.0f / 512;  // from there on, the last pixel has all of the weight
  // In this order NaN becomes 0.
  x = std::min(std::max(0.0f, x), static_cast<float>(color.width) - kLast);
  y = std::min(std::max(0.0f, y), static_cast<float>(color.height) - kLast);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const auto in_256ths = [](float share) {
    return static_cast<std::uint64_t>(static_cast<int>(256 * share + 0.5f));
  };
  const std::uint64_t right = in_256ths(x - static_cast<float>(left)),
                      bottom = in_256ths(y - static_cast<float>(top));
  const Rgb8* above = &color.at(left, top);
  const std::uint64_t mixed = mix(mix(above, right), mix(above + color.width, right), bottom);
  return {static_cast<std::uint8_t>(mixed), static_cast<std::uint8_t>(mixed >> 32),
          static_cast<std::uint8_t>(mixed >> 16)};
}

}  // namespace hermite::frame
