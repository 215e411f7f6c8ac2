#include "core/track/light_changes.h"

#include <algorithm>
#include <cmath>

#include "core/base/frame_helpers.h"
#include "core/track/coarse_masks.h"

namespace hermite {

namespace {

// Grey values, and share of them, by which a coarse pixel may differ: noise of mean grey values, shading of the lens that
// is not learned yet, and surfaces that do not look the same from everywhere.
constexpr double kTolerated_grey = 8, kToleratedShare = 0.06;

// Nothing is known of pixels that are brighter than this, or of the exposure from darker ones.
constexpr float kSaturated_grey = 250, kDark_grey = 10;

// Share of the pixels; smaller regions are edges and highlights of small things. And share of the surface, above which it
// is the image as a whole that changes.
constexpr double kLeastPatch = 0.002, kMostChanged = 0.35;

// The edge of a region, which pulls, is in the coarse pixels beside it.
constexpr int kAround_px = 2;

// What a view shows around a point: grey values within a pixel of it.
struct Shown {
  float low = 0, high = -1, middle = 0;  // high < low: nothing, or another surface
  bool is_known() const { return high >= low; }
};

Shown shown_at(const SeenView& seen, const Eigen::Vector3d& point) {
  Shown shown;
  if (point.z() < 0.05) return shown;
  const CoarseView& view = seen.view;
  const Eigen::Vector2d uv = view.project(point);
  const int x = static_cast<int>(std::lround(uv.x())), y = static_cast<int>(std::lround(uv.y()));
  if (!view.contains(x - 1, y - 1) || !view.contains(x + 1, y + 1)) return shown;
  float low = 255, high = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const std::size_t i = view.index(x + dx, y + dy);
      const double behind_m = view.normals[i].cast<double>().dot(point - view.point(x + dx, y + dy));
      if (view.depth_m[i] <= 0 || seen.moving[i] != 0 || std::abs(behind_m) > clearly_m(point.z())) return shown;
      low = std::min(low, view.grey[i]);
      high = std::max(high, view.grey[i]);
    }
  return {low, high, view.grey[view.index(x, y)]};
}

// Returns by how much brighter the frame is than the view, by row, since mains light makes bands: medians over what both
// show in that row and those beside it. 0: too little is seen in both.
std::vector<double> gains_of(const CoarseView& frame, const std::vector<Shown>& shown) {
  constexpr int kBeside = 2;
  constexpr std::size_t kLeastPixels = 50;
  const int width = static_cast<int>(frame.camera.width), height = static_cast<int>(frame.camera.height);
  std::vector<double> by_row(static_cast<std::size_t>(height), 0);
  std::vector<float> gains;
  for (int row = 0; row < height; ++row) {
    gains.clear();
    for (int y = std::max(0, row - kBeside); y <= std::min(height - 1, row + kBeside); ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = frame.index(x, y);
        const bool is_usable = shown[i].is_known() && std::min(frame.grey[i], shown[i].middle) > kDark_grey &&
                               std::max(frame.grey[i], shown[i].middle) < kSaturated_grey;
        if (is_usable) gains.push_back(frame.grey[i] / shown[i].middle);
      }
    if (gains.size() < kLeastPixels) continue;
    const auto middle = gains.begin() + static_cast<std::ptrdiff_t>(gains.size() / 2);
    std::nth_element(gains.begin(), middle, gains.end());
    by_row[static_cast<std::size_t>(row)] = static_cast<double>(*middle);
  }
  return by_row;
}

// What a view says about the brightness of each pixel of the frame.
enum class Light : std::uint8_t { kUnknown, kSame, kChanged };

std::vector<Light> light_since(const CoarseView& frame, const CoarseMask& moving, const SeenView& seen, const Rigid3& view_from_frame) {
  std::vector<Shown> shown(frame.size());
  for (int y = 0; y < static_cast<int>(frame.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(frame.camera.width); ++x) {
      const std::size_t i = frame.index(x, y);
      if (frame.depth_m[i] > 0 && moving[i] == 0) shown[i] = shown_at(seen, view_from_frame * frame.point(x, y));
    }
  const std::vector<double> gains = gains_of(frame, shown);
  std::vector<Light> light(frame.size(), Light::kUnknown);
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double gain = gains[i / frame.camera.width];
    if (!shown[i].is_known() || gain == 0) continue;
    const double low = gain * static_cast<double>(shown[i].low), high = gain * static_cast<double>(shown[i].high);
    const double grey = static_cast<double>(frame.grey[i]), tolerance = kTolerated_grey + kToleratedShare * grey;
    light[i] = grey < low - tolerance || grey > high + tolerance ? Light::kChanged : Light::kSame;
  }
  return light;
}

}  // namespace

CoarseMask changed_light(const CoarseView& frame, const Rigid3& world_from_camera, const CoarseMask& moving,
                         const std::deque<SeenView>& earlier) {
  std::vector<std::vector<Light>> by_view(earlier.size());
  in_parallel_of_frame(earlier.size(), [&](std::size_t i) {
    by_view[i] = light_since(frame, moving, earlier[i], inverse(earlier[i].world_from_camera) * world_from_camera);
  });
  CoarseMask changed(frame.size(), 0);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    int against = 0, in_favour = 0;
    for (const std::vector<Light>& light : by_view) {
      against += light[i] == Light::kChanged ? 1 : 0;
      in_favour += light[i] == Light::kSame ? 1 : 0;
    }
    changed[i] = against > 0 && 2 * against >= in_favour ? 1 : 0;
  }
  const auto least = static_cast<std::size_t>(std::ceil(kLeastPatch * static_cast<double>(frame.size())));
  changed = regions(changed, CoarseMask(frame.size(), 0), frame, least);
  if (share_of_surface(changed, frame) > kMostChanged) changed.assign(frame.size(), 0);
  return grown(changed, frame, kAround_px);
}

}  // namespace hermite
