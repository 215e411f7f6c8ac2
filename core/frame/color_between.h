// A colour between pixels.
#pragma once

#include "core/base/image.h"

namespace hermite {

// Bilinear between the four pixels around (x, y); black unless all four are in the image.
inline Rgb8 color_between(const ColorImage& color, float x, float y) {
  if (!(x >= 0 && y >= 0)) return {0, 0, 0};
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  if (left + 1 >= color.width || top + 1 >= color.height) return {0, 0, 0};
  const float right_share = x - static_cast<float>(left), bottom_share = y - static_cast<float>(top);
  const Rgb8 nw = color.at(left, top), ne = color.at(left + 1, top), sw = color.at(left, top + 1), se = color.at(left + 1, top + 1);
  const auto mix = [&](std::uint8_t Rgb8::*channel) {
    const auto blend = [](float a, float b, float share) { return a + share * (b - a); };
    const float above = blend(nw.*channel, ne.*channel, right_share), below = blend(sw.*channel, se.*channel, right_share);
    return static_cast<std::uint8_t>(blend(above, below, bottom_share) + 0.5f);
  };
  return {mix(&Rgb8::r), mix(&Rgb8::g), mix(&Rgb8::b)};
}

}  // namespace hermite
