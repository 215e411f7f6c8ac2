#include "core/frame/picture_features.h"

#include <algorithm>
#include <cmath>

namespace hermite {

namespace {

// Motion is measured to a tenth of a pixel of an image this wide; larger images are halved.
constexpr int kEnough_px = 480;

// A level with fewer pixels in a direction would show no more than its mean.
constexpr int kLeastSide_px = 15;

// The strongest corner of each cell, at a distance from the image border for its tracking window.
// The score is the smaller eigenvalue of the structure tensor (Shi, Tomasi 1994), as a mean over
// the window in squared grey values; the threshold is three times an image's noise.
constexpr int kCell_px = 16, kMargin_px = 6, kWindow_px = 2;
constexpr float kLeastCorner = 10;

int grey_of(const ColorImage& color, int x, int y) {
  const auto& pixel = color.at(x, y);
  return (77 * pixel.r + 150 * pixel.g + 29 * pixel.b) >> 8;
}

GreyImage grey_image(const ColorImage& color, int step) {
  GreyImage image{color.width / step, color.height / step, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      int sum = 0;
      for (int dy = 0; dy < step; ++dy)
        for (int dx = 0; dx < step; ++dx) sum += grey_of(color, step * x + dx, step * y + dy);
      image.pixels.push_back(static_cast<std::uint8_t>(sum / (step * step)));
    }
  return image;
}

GreyImage halved(const GreyImage& fine) {
  GreyImage image{fine.width / 2, fine.height / 2, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.pixels.push_back(static_cast<std::uint8_t>(
          (fine.at(2 * x, 2 * y) + fine.at(2 * x + 1, 2 * y) + fine.at(2 * x, 2 * y + 1) + fine.at(2 * x + 1, 2 * y + 1) + 2) / 4));
  return image;
}

// Products of gradients, summed over the window.
struct Tensor {
  float xx = 0, xy = 0, yy = 0;
  void operator+=(const Tensor& other) { xx += other.xx, xy += other.xy, yy += other.yy; }
  float smaller_eigenvalue() const { return 0.5f * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy)); }
};

std::vector<Corner> corners_of(const GreyImage& image) {
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<Tensor> rows(image.pixels.size());  // sums along the row
  for (int y = 1; y + 1 < image.height; ++y)
    for (int x = 1 + kWindow_px; x + 1 + kWindow_px < image.width; ++x)
      for (int dx = -kWindow_px; dx <= kWindow_px; ++dx) {
        const auto gx = static_cast<float>(image.at(x + dx + 1, y) - image.at(x + dx - 1, y)) / 2;
        const auto gy = static_cast<float>(image.at(x + dx, y + 1) - image.at(x + dx, y - 1)) / 2;
        rows[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] += {gx * gx, gx * gy, gy * gy};
      }
  constexpr float kPixels = (2 * kWindow_px + 1) * (2 * kWindow_px + 1);
  std::vector<Corner> corners;
  for (int top = kMargin_px; top < image.height - kMargin_px; top += kCell_px)
    for (int left = kMargin_px; left < image.width - kMargin_px; left += kCell_px) {
      Corner best;
      float most = kLeastCorner;
      for (int y = top; y < std::min(top + kCell_px, image.height - kMargin_px); ++y)
        for (int x = left; x < std::min(left + kCell_px, image.width - kMargin_px); ++x) {
          Tensor sum;
          for (int dy = -kWindow_px; dy <= kWindow_px; ++dy)
            sum += rows[static_cast<std::size_t>(y + dy) * width + static_cast<std::size_t>(x)];
          const float corner = sum.smaller_eigenvalue() / kPixels;
          if (corner <= most) continue;
          most = corner;
          best = {static_cast<float>(x), static_cast<float>(y), 0};
        }
      if (most > kLeastCorner) corners.push_back(best);
    }
  return corners;
}

// Appends coarser levels.
void add_levels(std::vector<GreyImage>& levels) {
  while (std::min(levels.back().width, levels.back().height) >= 2 * kLeastSide_px) levels.push_back(halved(levels.back()));
}

}  // namespace

float depth_around(const DepthImage& depth, int x, int y, double units_per_metre, const FrameOptions& options) {
  std::vector<float> measured;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= depth.width || y + dy >= depth.height) continue;
      const double depth_m = depth.at(x + dx, y + dy) / units_per_metre;
      if (depth_m >= options.depth_min_m && depth_m <= options.depth_max_m) measured.push_back(static_cast<float>(depth_m));
    }
  if (measured.size() < 5) return 0;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle;
}

PictureFeatures features_of(const RgbdFrame& frame, double depth_units_per_metre, const FrameOptions& options) {
  PictureFeatures features;
  features.image_px = frame.color.width >= kEnough_px ? 2 : 1;
  features.levels.push_back(grey_image(frame.color, features.image_px));
  add_levels(features.levels);
  features.corners = corners_of(features.levels[0]);
  for (Corner& corner : features.corners)
    corner.depth_m = depth_around(frame.depth, features.image_px * static_cast<int>(corner.x),
                                  features.image_px * static_cast<int>(corner.y), depth_units_per_metre, options);
  return features;
}

// Only the finest level is saved; the coarser levels follow from it.
void save(ByteWriter& bytes, const PictureFeatures& features) {
  const GreyImage none, &finest = features.levels.empty() ? none : features.levels[0];
  bytes.number(features.image_px);
  bytes.number(finest.width);
  bytes.number(finest.height);
  bytes.numbers(finest.pixels);
  bytes.numbers(features.corners);
}

void restore(ByteReader& bytes, PictureFeatures& features) {
  GreyImage finest;
  features = {};
  bytes.number(features.image_px);
  bytes.number(finest.width);
  bytes.number(finest.height);
  bytes.numbers(finest.pixels);
  bytes.numbers(features.corners);
  const bool fits = finest.width >= 0 && finest.height >= 0 &&
                    finest.pixels.size() == static_cast<std::uint64_t>(finest.width) * static_cast<std::uint64_t>(finest.height);
  const auto is_inside = [&finest](const Corner& corner) {
    return corner.x >= 0 && corner.y >= 0 && corner.x < static_cast<float>(finest.width) && corner.y < static_cast<float>(finest.height) &&
           std::isfinite(corner.depth_m);
  };
  bytes.require(fits && (features.image_px == 1 || features.image_px == 2) &&
                    std::all_of(features.corners.begin(), features.corners.end(), is_inside),
                "the image features are inconsistent");
  if (!bytes.ok() || finest.pixels.empty()) return;
  features.levels.push_back(std::move(finest));
  add_levels(features.levels);
}

}  // namespace hermite
