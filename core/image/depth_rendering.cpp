#include "core/image/depth_rendering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hermite::image {

namespace {

// Share left out at either end: pixels beside edges, which belong to nothing.
constexpr double kLeftOutShare = 0.01;

// Factors of 1, x, x^2, ... for x from 0 (blue) to 1 (red).
using Polynomial = std::array<double, 6>;
constexpr Polynomial kRed{0.13572138,   4.61539260,    -42.66032258,
                          132.13108234, -152.94239396, 59.28637943};
constexpr Polynomial kGreen{0.09140261,   2.19418839, 4.84296658,
                            -14.18503333, 4.27729857, 2.82956604};
constexpr Polynomial kBlue{0.10667330,   12.64194608,  -60.58204836,
                           110.36276771, -89.90310912, 27.34824973};

std::uint8_t value_at(const Polynomial& factors, double x) {
  double sum = 0;
  for (std::size_t i = factors.size(); i-- > 0;) sum = sum * x + factors[i];
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(sum, 0.0, 1.0)));
}

std::array<Rgb8, 256> turbo_colors() {
  std::array<Rgb8, 256> colors;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const double x = static_cast<double>(i) / 255;
    colors[i] = {value_at(kRed, x), value_at(kGreen, x), value_at(kBlue, x)};
  }
  return colors;
}

}  // namespace

DepthExtent extent_of(const DepthImage& depth) {
  std::vector<std::size_t> counts(65536, 0);
  for (const std::uint16_t value : depth.pixels) ++counts[value];
  const std::size_t measured = depth.pixels.size() - counts[0];
  if (measured == 0) return {};
  const auto left_out = static_cast<std::size_t>(kLeftOutShare * static_cast<double>(measured));
  DepthExtent extent;
  extent.valid_share = static_cast<double>(measured) / static_cast<double>(depth.pixels.size());
  std::size_t value = 1;
  for (std::size_t passed = counts[value]; passed <= left_out;) passed += counts[++value];
  extent.range.nearest = static_cast<std::uint16_t>(value);
  value = counts.size() - 1;
  for (std::size_t passed = counts[value]; passed <= left_out;) passed += counts[--value];
  extent.range.farthest = static_cast<std::uint16_t>(value);
  return extent;
}

ColorImage depth_rendering(const DepthImage& depth, const DepthRange& range) {
  static const std::array<Rgb8, 256> colors = turbo_colors();
  const double span = std::max(1, range.farthest - range.nearest);
  std::vector<Rgb8> color_of(65536);
  for (std::size_t value = 1; value < color_of.size(); ++value) {
    const double share = std::clamp((static_cast<double>(value) - range.nearest) / span, 0.0, 1.0);
    color_of[value] = colors[static_cast<std::size_t>(std::lround(255 * (1 - share)))];
  }
  ColorImage rendering(depth.width, depth.height);
  std::transform(depth.pixels.begin(), depth.pixels.end(), rendering.pixels.begin(),
                 [&](std::uint16_t value) { return color_of[value]; });
  return rendering;
}

}  // namespace hermite::image
