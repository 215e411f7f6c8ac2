// Rectangles on pages. Pure functions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/result.h"

namespace hermite {

struct RectangleSize {
  int width = 0, height = 0;
};

struct RectanglePlace {
  int page = 0, x = 0, y = 0;  // of the upper left corner
};

struct Packing {
  std::vector<RectanglePlace> places;  // in the order of the rectangles
  std::vector<RectangleSize> pages;    // just as large as they need to be, in steps of 16, at most the side that was asked for
};

// Highest first, each where its lower edge comes highest above what lies there already (skyline, bottom left: Jylanki 2010), on the first
// page where it fits. None: they need more than `max_pages`. CHECK: a rectangle is larger than a page.
std::optional<Packing> packed(const std::vector<RectangleSize>& rectangles, int page_side, int max_pages);

}  // namespace hermite
