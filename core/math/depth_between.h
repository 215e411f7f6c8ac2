// Interpolation of depth between pixels. Header only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/image.h"

namespace hermite {

// Two neighbouring pixels of one surface differ in depth by less than this share: that of a surface
// seen at 72 degrees by a camera of 320x240 pixels is 1.2 %, and 3 % are three standard deviations
// of a Kinect's noise at 3 m.
inline constexpr double kOneSurface = 0.03;

// Returns the depth at position (x, y) [px]: interpolated bilinearly between the four pixels around
// it if they are of one surface, in inverse depth, which is linear over the image of a plane; else
// that of the nearest pixel. 0: outside of the image, or without depth there.
inline std::uint16_t depth_between(const DepthImage& depth, double x, double y) {
  const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
  if (column < 0 || row < 0 || column >= depth.width || row >= depth.height) return 0;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  if (left < 0 || top < 0 || left + 1 >= depth.width || top + 1 >= depth.height)
    return depth.at(column, row);
  const std::uint16_t four[] = {depth.at(left, top), depth.at(left + 1, top),
                                depth.at(left, top + 1), depth.at(left + 1, top + 1)};
  const auto [nearest, farthest] = std::minmax({four[0], four[1], four[2], four[3]});
  if (nearest == 0 || farthest - nearest > kOneSurface * nearest) return depth.at(column, row);
  const double right = x - left, below = y - top;
  const double inverse = (1 - below) * ((1 - right) / four[0] + right / four[1]) +
                         below * ((1 - right) / four[2] + right / four[3]);
  return static_cast<std::uint16_t>(std::lround(1 / inverse));
}

}  // namespace hermite
