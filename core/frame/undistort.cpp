#include "core/frame/undistort.h"

#include <algorithm>
#include <cmath>

namespace hermite {

namespace {

Rgb8 between(const ColorImage& color, float x, float y) {
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  if (left < 0 || top < 0 || left + 1 >= color.width || top + 1 >= color.height) return {0, 0, 0};
  const float right_share = x - static_cast<float>(left), bottom_share = y - static_cast<float>(top);
  const Rgb8 nw = color.at(left, top), ne = color.at(left + 1, top), sw = color.at(left, top + 1), se = color.at(left + 1, top + 1);
  const auto mix = [&](std::uint8_t Rgb8::*channel) {
    const auto blend = [](float a, float b, float share) { return a + share * (b - a); };
    const float above = blend(nw.*channel, ne.*channel, right_share), below = blend(sw.*channel, se.*channel, right_share);
    return static_cast<std::uint8_t>(blend(above, below, bottom_share) + 0.5f);
  };
  return {mix(&Rgb8::r), mix(&Rgb8::g), mix(&Rgb8::b)};
}

}  // namespace

Undistorter::Undistorter(const Camera& camera) {
  sources_.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d at = camera.distort(x, y);
      // Far outside is outside: the cast below stays in range.
      const auto pixel = [](double value, int side) { return static_cast<float>(std::clamp(value, -2.0, side + 1.0)); };
      sources_.push_back({pixel(at.x(), camera.width), pixel(at.y(), camera.height)});
    }
}

RgbdFrame Undistorter::apply(const RgbdFrame& frame) const {
  RgbdFrame straight{frame.timestamp_s, DepthImage(frame.depth.width, frame.depth.height),
                     ColorImage(frame.color.width, frame.color.height)};
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const auto [x, y] = sources_[i];
    const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
    const bool inside = column >= 0 && row >= 0 && column < frame.depth.width && row < frame.depth.height;
    straight.depth.pixels[i] = inside ? frame.depth.at(column, row) : std::uint16_t{0};
    straight.color.pixels[i] = between(frame.color, x, y);
  }
  return straight;
}

}  // namespace hermite
