#include "core/texture/atlas_packing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/base/check.h"

namespace hermite::texture {

namespace {

constexpr int kPageStep = 16;
// Least share of a page's area that the rectangles of charts fill, from which the width of a page
// that will not be full is chosen.
constexpr double kFill = 0.8;

int rounded_up(int side) { return (side + kPageStep - 1) / kPageStep * kPageStep; }

// The border of the placed rectangles, as steps from left to right.
class Skyline {
 public:
  Skyline(int width, int height) : width_(width), height_(height), steps_{{0, 0}} {}

  bool place(const RectangleSize& size, RectanglePlace& place) {
    std::size_t best = steps_.size();
    int best_y = height_;
    for (std::size_t i = 0; i < steps_.size() && steps_[i].x + size.width <= width_; ++i) {
      const int y = lowest_over(i, size.width);
      if (y + size.height > height_ || y >= best_y) continue;
      best = i;
      best_y = y;
    }
    if (best == steps_.size()) return false;
    place.x = steps_[best].x;
    place.y = best_y;
    raise(best, size.width, best_y + size.height);
    return true;
  }
  int used_height() const { return used_height_; }
  int used_width() const { return used_width_; }

 private:
  struct Step {
    int x, y;
  };

  int lowest_over(std::size_t first, int width) const {
    int y = 0;
    for (std::size_t i = first; i < steps_.size() && steps_[i].x < steps_[first].x + width; ++i)
      y = std::max(y, steps_[i].y);
    return y;
  }

  void raise(std::size_t first, int width, int y) {
    const int left = steps_[first].x, right = left + width;
    used_height_ = std::max(used_height_, y);
    used_width_ = std::max(used_width_, right);
    std::size_t last = first;
    int y_behind = 0;
    while (last < steps_.size() && steps_[last].x < right) y_behind = steps_[last++].y;
    const bool ends_with_step =
        right == width_ || (last < steps_.size() && steps_[last].x == right);
    steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(first),
                 steps_.begin() + static_cast<std::ptrdiff_t>(last));
    const auto at =
        steps_.insert(steps_.begin() + static_cast<std::ptrdiff_t>(first), Step{left, y});
    if (!ends_with_step) steps_.insert(at + 1, Step{right, y_behind});
  }

  const int width_, height_;
  std::vector<Step> steps_;
  int used_height_ = 0, used_width_ = 0;
};

}  // namespace

std::optional<Packing> packed(const std::vector<RectangleSize>& rectangles, int page_side,
                              int max_pages) {
  Packing packing;
  packing.places.resize(rectangles.size());
  double area = 0;
  int widest = 1;
  for (const RectangleSize& size : rectangles) {
    CHECK(size.width > 0 && size.height > 0 && size.width <= page_side && size.height <= page_side,
          "a rectangle that fits no page");
    area += static_cast<double>(size.width) * size.height;
    widest = std::max(widest, size.width);
  }
  if (area > static_cast<double>(page_side) * page_side * max_pages) return std::nullopt;
  const int square = rounded_up(
      static_cast<int>(std::min(std::sqrt(area / kFill), static_cast<double>(page_side))));
  const int width = std::min(std::max(square, rounded_up(widest)), page_side);
  std::vector<std::size_t> order(rectangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const RectangleSize &first = rectangles[a], &second = rectangles[b];
    return first.height != second.height ? first.height > second.height
                                         : first.width > second.width;
  });
  std::vector<Skyline> skylines;
  for (const std::size_t i : order) {
    RectanglePlace& place = packing.places[i];
    while (place.page < static_cast<int>(skylines.size()) &&
           !skylines[static_cast<std::size_t>(place.page)].place(rectangles[i], place))
      ++place.page;
    if (place.page < static_cast<int>(skylines.size())) continue;
    if (place.page == max_pages) return std::nullopt;
    skylines.emplace_back(width, page_side);
    CHECK(skylines.back().place(rectangles[i], place), "an empty page has room");
  }
  for (const Skyline& skyline : skylines)
    packing.pages.push_back({std::min(page_side, rounded_up(skyline.used_width())),
                             std::min(page_side, rounded_up(skyline.used_height()))});
  return packing;
}

}  // namespace hermite::texture
