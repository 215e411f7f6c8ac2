#include "core/frame/frame_content.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace hermite::frame {

namespace {

constexpr int kStep_px = 4;

int grey(Rgb8 c) { return (299 * c.r + 587 * c.g + 114 * c.b + 500) / 1000; }

// FNV-1a, applied per pixel instead of per byte.
std::uint64_t digest_of(const DepthImage& depth) {
  std::uint64_t digest = 0xcbf29ce484222325u;
  bool is_measured = false;
  for (const std::uint16_t pixel : depth.pixels) {
    digest = (digest ^ pixel) * 0x100000001b3u;
    is_measured = is_measured || pixel != 0;
  }
  return is_measured ? digest : 0;
}

}  // namespace

FrameContent content_of(const RgbdFrame& frame, double depth_units_per_metre,
                        const FrameOptions& options) {
  const double nearest = options.depth_min_m * depth_units_per_metre,
               farthest = options.depth_max_m * depth_units_per_metre;
  FrameContent content;
  content.depth_digest = digest_of(frame.depth);
  std::vector<std::uint16_t> depths;
  double grey_sum = 0, change_sum = 0, count = 0;
  for (int y = 0; y + 1 < frame.depth.height; y += kStep_px)
    for (int x = 0; x + 1 < frame.depth.width; x += kStep_px) {
      const std::uint16_t depth = frame.depth.at(x, y);
      ++count;
      if (depth > farthest)
        ++content.too_far;
      else if (depth >= nearest)
        depths.push_back(depth);
      else if (depth > 0)
        ++content.too_near;
      const int here = grey(frame.color.at(x, y));
      grey_sum += here;
      change_sum += 0.5 * (std::abs(grey(frame.color.at(x + 1, y)) - here) +
                           std::abs(grey(frame.color.at(x, y + 1)) - here));
    }
  if (count == 0) return content;
  content.in_range = static_cast<double>(depths.size()) / count;
  content.too_near /= count;
  content.too_far /= count;
  content.mean_grey = grey_sum / count;
  content.texture = change_sum / count;
  if (!depths.empty()) {
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    content.median_m = *middle / depth_units_per_metre;
  }
  return content;
}

}  // namespace hermite::frame
