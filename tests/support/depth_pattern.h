// Depth images from a formula, for tests. Header only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/base/image.h"

namespace hermite::test {

// `value` gets the index of the pixel, row by row.
inline DepthImage make_depth(image::ImageSize size,
                             const std::function<std::uint16_t(std::size_t)>& value) {
  DepthImage depth(size.width, size.height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) depth.pixels[i] = value(i);
  return depth;
}

}  // namespace hermite::test
