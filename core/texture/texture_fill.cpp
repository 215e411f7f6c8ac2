#include "core/texture/texture_fill.h"

#include <algorithm>
#include <array>
#include <utility>

namespace hermite::texture {

namespace {

using Eigen::Vector3f;

// Returns the image at half the size: the mean of those of the 2 x 2 pixels that have a value.
std::pair<Image<Vector3f>, Image<std::uint8_t>> halved_values(
    const Image<Vector3f>& values, const Image<std::uint8_t>& has_value) {
  const int width = (values.width + 1) / 2, height = (values.height + 1) / 2;
  std::pair<Image<Vector3f>, Image<std::uint8_t>> half{{width, height}, {width, height}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Vector3f sum = Vector3f::Zero();
      int count = 0;
      for (const auto& [dx, dy] :
           {std::array{0, 0}, std::array{1, 0}, std::array{0, 1}, std::array{1, 1}}) {
        const int column = 2 * x + dx, row = 2 * y + dy;
        if (column >= values.width || row >= values.height || has_value.at(column, row) == 0)
          continue;
        sum += values.at(column, row);
        ++count;
      }
      half.first.at(x, y) =
          count > 0 ? Vector3f(sum / static_cast<float>(count)) : Vector3f(Vector3f::Zero());
      half.second.at(x, y) = count > 0 ? 1 : 0;
    }
  return half;
}

// Interpolates between the four surrounding pixels of the half-size image.
Vector3f from_half(const Image<Vector3f>& half, int x, int y) {
  const int near_x = x / 2, near_y = y / 2;
  const int far_x = std::clamp(near_x + (x % 2 == 0 ? -1 : 1), 0, half.width - 1);
  const int far_y = std::clamp(near_y + (y % 2 == 0 ? -1 : 1), 0, half.height - 1);
  return 0.5625f * half.at(near_x, near_y) +
         0.1875f * (half.at(far_x, near_y) + half.at(near_x, far_y)) +
         0.0625f * half.at(far_x, far_y);
}

}  // namespace

void fill_smoothly(Image<Vector3f>& values, const Image<std::uint8_t>& has_value) {
  const bool is_full = std::all_of(has_value.pixels.begin(), has_value.pixels.end(),
                                   [](std::uint8_t has) { return has != 0; });
  if (is_full) return;
  if (values.width == 1 && values.height == 1) {
    values.pixels[0] = Vector3f::Zero();
    return;
  }
  auto [half, half_has_value] = halved_values(values, has_value);
  fill_smoothly(half, half_has_value);
  for (int y = 0; y < values.height; ++y)
    for (int x = 0; x < values.width; ++x)
      if (has_value.at(x, y) == 0) values.at(x, y) = from_half(half, x, y);
}

}  // namespace hermite::texture
