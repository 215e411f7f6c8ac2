// Depth as an image for people: near is red, far is blue, and what was not measured is black. Pure
// and thread-safe.
#pragma once

#include <cstdint>

#include "core/base/image.h"

namespace hermite::image {

// Sensor units, `nearest` at most `farthest`.
struct DepthRange {
  std::uint16_t nearest = 0, farthest = 0;
};

struct DepthExtent {
  // Range without the nearest and the farthest hundredth of what was measured; zeros where nothing
  // was.
  DepthRange range;
  double valid_share = 0;  // of the pixels: was measured
};
DepthExtent extent_of(const DepthImage& depth);

// What lies outside of the range has the colour of its end. The colours are Turbo (Mikhailov 2019,
// Google; its polynomial of degree 5), whose brightness and hue both tell neighbours apart.
ColorImage depth_rendering(const DepthImage& depth, const DepthRange& range);

}  // namespace hermite::image
