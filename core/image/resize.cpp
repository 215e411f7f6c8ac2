#include "core/image/resize.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace hermite::image {
namespace {

// One new pixel along one axis: old pixels [first, first + weights.size()), weights that add up
// to 1.
struct Coverage {
  int first = 0;
  std::vector<float> weights;
};

std::vector<Coverage> coverages(int old_count, int new_count) {
  std::vector<Coverage> all(static_cast<std::size_t>(new_count));
  const double step = static_cast<double>(old_count) / new_count;
  for (int i = 0; i < new_count; ++i) {
    const double begin = i * step, end = std::min<double>((i + 1) * step, old_count);
    Coverage& coverage = all[static_cast<std::size_t>(i)];
    coverage.first = std::min(static_cast<int>(begin), old_count - 1);
    for (int old = coverage.first; old < old_count && old < end; ++old)
      coverage.weights.push_back(static_cast<float>(
          (std::min<double>(old + 1, end) - std::max<double>(old, begin)) / step));
  }
  return all;
}

std::uint8_t rounded(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5f, 0.0f, 255.0f));
}

Rgb8 mean_of(const ColorImage& image, const Coverage& columns, const Coverage& rows) {
  float r = 0, g = 0, b = 0;
  for (std::size_t y = 0; y < rows.weights.size(); ++y)
    for (std::size_t x = 0; x < columns.weights.size(); ++x) {
      const Rgb8& pixel =
          image.at(columns.first + static_cast<int>(x), rows.first + static_cast<int>(y));
      const float weight = rows.weights[y] * columns.weights[x];
      r += weight * pixel.r;
      g += weight * pixel.g;
      b += weight * pixel.b;
    }
  return {rounded(r), rounded(g), rounded(b)};
}

}  // namespace

ColorImage resize_color(const ColorImage& image, ImageSize size) {
  CHECK(!image.pixels.empty() && size.width > 0 && size.height > 0, "an image of no size");
  const std::vector<Coverage> columns = coverages(image.width, size.width),
                              rows = coverages(image.height, size.height);
  ColorImage resized(size.width, size.height);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      resized.at(x, y) =
          mean_of(image, columns[static_cast<std::size_t>(x)], rows[static_cast<std::size_t>(y)]);
  return resized;
}

}  // namespace hermite::image
