// Image pyramids of the views' brightness, from which poses and warps of views are estimated. Pure,
// thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/texture/texture_view.h"

namespace hermite::texture {

// Differences of brightness, 0 to 255, up to this have full weight.
inline constexpr float kUsualDifference = 12;

struct BrightnessSample {
  // 0 to 255, and its derivatives per pixel of the full-size image.
  float value = 0, du = 0, dv = 0;
};

// All views at one size: full, half or quarter.
struct BrightnessLevel {
  std::vector<Image<std::uint8_t>> images;
  float scale = 1;

  // Returns the bilinear value at a position in the full-size image [px]; std::nullopt outside.
  std::optional<BrightnessSample> at(std::size_t view, float u, float v) const;
};

// Number of levels of an image pyramid.
inline constexpr std::size_t kBrightnessLevels = 3;

// Returns gain-corrected images, smoothed by 3 x 3 (1 2 1). The last level has the full-size
// images, each level before it half the size of the next.
std::array<BrightnessLevel, kBrightnessLevels> brightness_levels(
    const std::vector<TextureView>& views, int thread_count);

// Returns 1 up to kUsualDifference and less beyond (Huber).
float robust_weight(float difference);

// The brightness of a sample in a view.
struct Look {
  float value = 0, weight = 0;  // weight 0: outside the image
};

// The weighted sum of the views' brightness of one sample.
struct PointMean {
  double weight = 0, sum = 0;

  // Returns the mean without the contribution `own`; std::nullopt if no other view sees the point.
  std::optional<float> without(const Look& own) const;
};

}  // namespace hermite::texture
