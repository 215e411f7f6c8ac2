// Packs rectangles onto pages. Pure functions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/result.h"

namespace hermite::texture {

struct RectangleSize {
  int width = 0, height = 0;
};

struct RectanglePlace {
  int page = 0, x = 0, y = 0;  // of the upper left corner
};

struct Packing {
  std::vector<RectanglePlace> places;  // in the order of the rectangles
  // As large as needed, in steps of 16, at most the requested side.
  std::vector<RectangleSize> pages;
};

// Places the tallest rectangles first, on the first page where they fit, by the skyline bottom-left
// heuristic (Jylanki 2010). Returns std::nullopt if more than `max_pages` would be needed. CHECK:
// no rectangle is larger than a page.
std::optional<Packing> packed(const std::vector<RectangleSize>& rectangles, int page_side,
                              int max_pages);

}  // namespace hermite::texture
