#include "core/frame/image_features.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace hermite::frame {

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
  image.pixels.reserve(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
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
  image.pixels.reserve(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.pixels.push_back(static_cast<std::uint8_t>(
          (fine.at(2 * x, 2 * y) + fine.at(2 * x + 1, 2 * y) + fine.at(2 * x, 2 * y + 1) +
           fine.at(2 * x + 1, 2 * y + 1) + 2) /
          4));
  return image;
}

// Products of doubled gradients, summed along a row or over a window: whole numbers, so that sums
// do not depend on their order.
struct Tensors {
  std::vector<int> xx, xy, yy;

  explicit Tensors(std::size_t count) : xx(count), xy(count), yy(count) {}

  // Adds or, with a sign of -1, removes the sums of another row.
  void add(const Tensors& row, int sign) {
    for (std::size_t i = 0; i < xx.size(); ++i) {
      xx[i] += sign * row.xx[i];
      xy[i] += sign * row.xy[i];
      yy[i] += sign * row.yy[i];
    }
  }

  // Returns the smaller eigenvalue of the mean over a window.
  float smaller_eigenvalue(std::size_t i) const {
    constexpr float kPixels = (2 * kWindow_px + 1) * (2 * kWindow_px + 1);
    const float a = static_cast<float>(xx[i]) / 4, b = static_cast<float>(xy[i]) / 4,
                c = static_cast<float>(yy[i]) / 4;
    return 0.5f * (a + c - std::sqrt((a - c) * (a - c) + 4 * b * b)) / kPixels;
  }
};

// Returns the sums along row y over the window's width; zero where the window leaves the image.
Tensors row_sums(const GreyImage& image, int y) {
  const auto width = static_cast<std::size_t>(image.width);
  const std::uint8_t *here = &image.pixels[static_cast<std::size_t>(y) * width],
                     *above = here - width, *below = here + width;
  Tensors products(width), sums(width);
  for (std::size_t x = 1; x + 1 < width; ++x) {
    const int gx = here[x + 1] - here[x - 1], gy = below[x] - above[x];
    products.xx[x] = gx * gx;
    products.xy[x] = gx * gy;
    products.yy[x] = gy * gy;
  }
  const auto sum = [](const std::vector<int>& of, std::size_t x) {
    int total = 0;
    for (std::size_t i = x - kWindow_px; i <= x + kWindow_px; ++i) total += of[i];
    return total;
  };
  for (std::size_t x = 1 + kWindow_px; x + 1 + kWindow_px < width; ++x) {
    sums.xx[x] = sum(products.xx, x);
    sums.xy[x] = sum(products.xy, x);
    sums.yy[x] = sum(products.yy, x);
  }
  return sums;
}

std::vector<Corner> corners_of(const GreyImage& image) {
  struct Best {
    Corner corner;
    float strength = kLeastCorner;
  };
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<Corner> corners;
  std::vector<Best> cells;   // of the row of cells that is being looked at
  std::deque<Tensors> rows;  // of the window
  Tensors window(width);
  const auto take = [&cells, &corners] {
    for (const Best& best : cells)
      if (best.strength > kLeastCorner) corners.push_back(best.corner);
  };
  for (int y = kMargin_px - kWindow_px; y < kMargin_px + kWindow_px; ++y) {
    if (y + 1 >= image.height) return corners;
    rows.push_back(row_sums(image, y));
    window.add(rows.back(), 1);
  }
  for (int y = kMargin_px; y < image.height - kMargin_px; ++y) {
    if ((y - kMargin_px) % kCell_px == 0) {
      take();
      cells.assign(width / kCell_px + 1, {});
    }
    rows.push_back(row_sums(image, y + kWindow_px));
    window.add(rows.back(), 1);
    for (int x = kMargin_px; x < image.width - kMargin_px; ++x) {
      Best& best = cells[static_cast<std::size_t>((x - kMargin_px) / kCell_px)];
      const float strength = window.smaller_eigenvalue(static_cast<std::size_t>(x));
      if (strength > best.strength)
        best = {{static_cast<float>(x), static_cast<float>(y), 0}, strength};
    }
    window.add(rows.front(), -1);
    rows.pop_front();
  }
  take();
  return corners;
}

// Appends coarser levels.
void add_levels(std::vector<GreyImage>& levels) {
  while (std::min(levels.back().width, levels.back().height) >= 2 * kLeastSide_px)
    levels.push_back(halved(levels.back()));
}

}  // namespace

float depth_around(const DepthImage& depth, int x, int y, double units_per_metre,
                   const FrameOptions& options) {
  std::vector<float> measured;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= depth.width || y + dy >= depth.height) continue;
      const double depth_m = depth.at(x + dx, y + dy) / units_per_metre;
      if (depth_m >= options.depth_min_m && depth_m <= options.depth_max_m)
        measured.push_back(static_cast<float>(depth_m));
    }
  if (measured.size() < 5) return 0;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle;
}

ImageFeatures features_of(const RgbdFrame& frame, double depth_units_per_metre,
                          const FrameOptions& options) {
  ImageFeatures features;
  features.image_px = frame.color.width >= kEnough_px ? 2 : 1;
  features.levels.push_back(grey_image(frame.color, features.image_px));
  add_levels(features.levels);
  features.corners = corners_of(features.levels[0]);
  for (Corner& corner : features.corners)
    corner.depth_m = depth_around(frame.depth, features.image_px * static_cast<int>(corner.x),
                                  features.image_px * static_cast<int>(corner.y),
                                  depth_units_per_metre, options);
  return features;
}

// Only the finest level is saved; the coarser levels follow from it.
void save(ByteWriter& bytes, const ImageFeatures& features) {
  const GreyImage none, &finest = features.levels.empty() ? none : features.levels[0];
  bytes.number(features.image_px);
  bytes.number(finest.width);
  bytes.number(finest.height);
  bytes.numbers(finest.pixels);
  bytes.numbers(features.corners);
}

void restore(ByteReader& bytes, ImageFeatures& features) {
  GreyImage finest;
  features = {};
  bytes.number(features.image_px);
  bytes.number(finest.width);
  bytes.number(finest.height);
  bytes.numbers(finest.pixels);
  bytes.numbers(features.corners);
  const bool fits = finest.width >= 0 && finest.height >= 0 &&
                    finest.pixels.size() == static_cast<std::uint64_t>(finest.width) *
                                                static_cast<std::uint64_t>(finest.height);
  const auto is_inside = [&finest](const Corner& corner) {
    return corner.x >= 0 && corner.y >= 0 && corner.x < static_cast<float>(finest.width) &&
           corner.y < static_cast<float>(finest.height) && std::isfinite(corner.depth_m);
  };
  bytes.require(fits && (features.image_px == 1 || features.image_px == 2) &&
                    std::all_of(features.corners.begin(), features.corners.end(), is_inside),
                "the image features are inconsistent");
  if (!bytes.ok() || finest.pixels.empty()) return;
  features.levels.push_back(std::move(finest));
  add_levels(features.levels);
}

}  // namespace hermite::frame
