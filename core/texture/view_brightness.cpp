#include "core/texture/view_brightness.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace hermite::texture {

namespace {

Image<std::uint8_t> brightness_of(const TextureView& view) {
  const int width = view.color.width, height = view.color.height;
  Image<float> plain(width, height);
  for (std::size_t i = 0; i < plain.pixels.size(); ++i) {
    const Rgb8& p = view.color.pixels[i];
    plain.pixels[i] = 0.299f * view.corrected[0][p.r] + 0.587f * view.corrected[1][p.g] +
                      0.114f * view.corrected[2][p.b];
  }
  Image<std::uint8_t> smooth(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          sum += static_cast<float>((2 - std::abs(dx)) * (2 - std::abs(dy))) *
                 plain.at(std::clamp(x + dx, 0, width - 1), std::clamp(y + dy, 0, height - 1));
      smooth.at(x, y) = static_cast<std::uint8_t>(std::clamp(sum / 16 + 0.5f, 0.0f, 255.0f));
    }
  return smooth;
}

Image<std::uint8_t> halved(const Image<std::uint8_t>& image) {
  Image<std::uint8_t> half(image.width / 2, image.height / 2);
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x)
      half.at(x, y) = static_cast<std::uint8_t>(
          (image.at(2 * x, 2 * y) + image.at(2 * x + 1, 2 * y) + image.at(2 * x, 2 * y + 1) +
           image.at(2 * x + 1, 2 * y + 1) + 2) /
          4);
  return half;
}

}  // namespace

std::optional<BrightnessSample> BrightnessLevel::at(std::size_t view, float u, float v) const {
  const Image<std::uint8_t>& image = images[view];
  const float column = (u + 0.5f) * scale - 0.5f, row = (v + 0.5f) * scale - 0.5f;
  if (!(column >= 0 && row >= 0 && column < static_cast<float>(image.width - 1) &&
        row < static_cast<float>(image.height - 1)))
    return std::nullopt;
  const int x = static_cast<int>(column), y = static_cast<int>(row);
  const float dx = column - static_cast<float>(x), dy = row - static_cast<float>(y);
  const float a = image.at(x, y), b = image.at(x + 1, y), c = image.at(x, y + 1),
              d = image.at(x + 1, y + 1);
  return BrightnessSample{(1 - dy) * ((1 - dx) * a + dx * b) + dy * ((1 - dx) * c + dx * d),
                          scale * ((1 - dy) * (b - a) + dy * (d - c)),
                          scale * ((1 - dx) * (c - a) + dx * (d - b))};
}

std::array<BrightnessLevel, kBrightnessLevels> brightness_levels(
    const std::vector<TextureView>& views, int thread_count) {
  std::array<BrightnessLevel, kBrightnessLevels> levels;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    levels[l].images.resize(views.size());
    levels[l].scale = 1 / static_cast<float>(1 << (levels.size() - 1 - l));
  }
  in_parallel(views.size(), thread_count, [&](std::size_t i) {
    levels.back().images[i] = brightness_of(views[i]);
    for (std::size_t l = levels.size() - 1; l > 0; --l)
      levels[l - 1].images[i] = halved(levels[l].images[i]);
  });
  return levels;
}

float robust_weight(float difference) {
  const float off = std::abs(difference) / kUsualDifference;
  return off <= 1 ? 1 : 1 / off;
}

std::optional<float> PointMean::without(const Look& own) const {
  const double others = weight - static_cast<double>(own.weight);
  if (others <= 0 || others < 1e-3 * weight) return std::nullopt;
  return static_cast<float>(
      (sum - static_cast<double>(own.weight) * static_cast<double>(own.value)) / others);
}

}  // namespace hermite::texture
