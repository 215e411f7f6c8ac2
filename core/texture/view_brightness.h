// Brightness of the views on the surface, coarse to fine: what poses and warps of views are found from. Pure, thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/texture/texture_view.h"

namespace hermite {

// Differences of brightness, 0 to 255, that count in full.
inline constexpr float kUsualDifference = 12;

struct Brightness {
  float value = 0, du = 0, dv = 0;  // 0 to 255; per pixel of the whole image
};

// All views at one size: whole, half or quarter.
struct BrightnessLevel {
  std::vector<Image<std::uint8_t>> images;
  float scale = 1;

  // Between the four pixels around a place of the whole image [px]; none: outside.
  std::optional<Brightness> at(std::size_t view, float u, float v) const;
};

// After the gain, smoothed by 3 x 3 (1 2 1). The last has the whole images, each before it half the size of the next.
inline constexpr std::size_t kBrightnessLevels = 3;
std::array<BrightnessLevel, kBrightnessLevels> brightness_levels(const std::vector<TextureView>& views, int thread_count);

// 1 up to kUsualDifference, less beyond (Huber).
float robust_weight(float difference);

// What a view has of a sample.
struct Look {
  float value = 0, weight = 0;  // 0: out of the image
};

// Of one sample the weighted sum of the views' brightness.
struct PointMean {
  double weight = 0, sum = 0;

  // Without what `own` had added to it; none where no other view sees the point.
  std::optional<float> without(const Look& own) const;
};

}  // namespace hermite
