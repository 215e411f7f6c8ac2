#include "core/track/coarse_masks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hermite::track {

namespace {

// Six times the noise of a Kinect v1 (Nguyen, Izadi, Lovell 2012) plus 3 cm for pose errors, as for
// Agreement::in_front (shaders/track/agreement.comp).
constexpr double kClearly_m = 0.03, kClearlyGrowth_per_m = 0.0114;

// A region is searched for in the next frame within this distance in coarse pixels and within this
// difference in depth.
constexpr int kReach_px = 2;
constexpr double kReach_m = 0.25;

}  // namespace

double clearly_m(double depth_m) { return kClearly_m + kClearlyGrowth_per_m * depth_m * depth_m; }

frame::CoarseMask grown(const frame::CoarseMask& mask, const frame::CoarseView& view,
                        int reach_px) {
  frame::CoarseMask result(mask.size(), 0);
  for (int y = 0; y < static_cast<int>(view.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(view.camera.width); ++x)
      for (int dy = -reach_px; mask[view.index(x, y)] != 0 && dy <= reach_px; ++dy)
        for (int dx = -reach_px; dx <= reach_px; ++dx)
          if (view.contains(x + dx, y + dy)) result[view.index(x + dx, y + dy)] = 1;
  return result;
}

frame::CoarseMask beside(const frame::CoarseMask& mask, const frame::CoarseView& view,
                         const frame::CoarseView& other) {
  frame::CoarseMask result(other.size(), 0);
  for (int y = 0; y < static_cast<int>(view.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(view.camera.width); ++x) {
      if (mask[view.index(x, y)] == 0) continue;
      for (int dy = -kReach_px; dy <= kReach_px; ++dy)
        for (int dx = -kReach_px; dx <= kReach_px; ++dx) {
          if (!other.contains(x + dx, y + dy)) continue;
          const std::size_t i = other.index(x + dx, y + dy);
          if (std::abs(other.depth_m[i] - view.depth_m[view.index(x, y)]) < kReach_m) result[i] = 1;
        }
    }
  return result;
}

frame::CoarseMask regions(const frame::CoarseMask& seeds, const frame::CoarseMask& candidates,
                          const frame::CoarseView& view, std::size_t least_pixels) {
  frame::CoarseMask result(seeds.size(), 0), visited(seeds.size(), 0);
  const int width = static_cast<int>(view.camera.width);
  std::vector<int> region;
  for (std::size_t start = 0; start < seeds.size(); ++start) {
    if (seeds[start] == 0 || visited[start] != 0) continue;
    region.assign(1, static_cast<int>(start));
    visited[start] = 1;
    for (std::size_t next = 0; next < region.size(); ++next) {
      const int x = region[next] % width, y = region[next] / width;
      const float depth_m = view.depth_m[static_cast<std::size_t>(region[next])];
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (!view.contains(x + dx, y + dy)) continue;
        const std::size_t i = view.index(x + dx, y + dy);
        const bool connected = std::abs(view.depth_m[i] - depth_m) < clearly_m(depth_m);
        if (visited[i] != 0 || !(seeds[i] != 0 || (candidates[i] != 0 && connected))) continue;
        visited[i] = 1;
        region.push_back(static_cast<int>(i));
      }
    }
    if (region.size() < least_pixels) continue;
    for (const int i : region) result[static_cast<std::size_t>(i)] = 1;
  }
  return result;
}

bool has_any(const frame::CoarseMask& mask) { return std::ranges::find(mask, 1u) != mask.end(); }

bool is_in(const frame::CoarseMask& mask, const frame::CoarseView& view,
           const Eigen::Vector2d& pixel, const Camera& camera) {
  const int width = static_cast<int>(view.camera.width),
            height = static_cast<int>(view.camera.height);
  const int x = static_cast<int>(pixel.x()) * width / camera.width,
            y = static_cast<int>(pixel.y()) * height / camera.height;
  return mask[view.index(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1))] != 0;
}

std::optional<frame::RgbdFrame> without_depth_in(const frame::CoarseMask& mask,
                                                 const frame::CoarseView& view,
                                                 const frame::RgbdFrame& frame) {
  if (!has_any(mask)) return std::nullopt;
  frame::RgbdFrame rest = frame;
  const int width = static_cast<int>(view.camera.width),
            height = static_cast<int>(view.camera.height);
  const auto first_px = [](int cell, int of_cells, int pixels) {
    return (cell * pixels + of_cells - 1) / of_cells;
  };
  for (int cell_y = 0; cell_y < height; ++cell_y)
    for (int cell_x = 0; cell_x < width; ++cell_x) {
      if (mask[view.index(cell_x, cell_y)] == 0) continue;
      const int left = first_px(cell_x, width, frame.depth.width),
                right = first_px(cell_x + 1, width, frame.depth.width);
      for (int y = first_px(cell_y, height, frame.depth.height);
           y < first_px(cell_y + 1, height, frame.depth.height); ++y)
        std::fill(&rest.depth.at(left, y), &rest.depth.at(left, y) + (right - left),
                  std::uint16_t{0});
    }
  return rest;
}

double share_of_surface(const frame::CoarseMask& mask, const frame::CoarseView& view) {
  std::size_t surface = 0, masked = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (view.depth_m[i] <= 0) continue;
    ++surface;
    masked += mask[i];
  }
  return surface > 0 ? static_cast<double>(masked) / static_cast<double>(surface) : 0;
}

}  // namespace hermite::track
