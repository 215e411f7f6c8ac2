#include "core/evaluate/registration_check.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace hermite::evaluate {
namespace {

// The two cameras of a Kinect differ by 10 % in focal length and by 25 mm, which is 19 pixels at
// 0.7 m.
constexpr double kScaleStep = 0.02;
constexpr int kShiftStep_px = 2;
constexpr double kMinGain = 1.15;  // registered recordings gain up to 1.06 by chance
constexpr double kMinDisplacement_px = 5;
constexpr std::int64_t kMinEdges = 2000;
constexpr std::size_t kMaxEdgesPerFrame = 3000;
// Share of the edges that must remain in the image for a displacement to be compared.
constexpr double kMinInside = 0.7;
constexpr int kReach_px = 2;  // distance of the two pixels whose depths are compared
// Share of the nearer depth: more than the slope of a floor at a grazing angle.
constexpr double kMinStep = 0.06;
constexpr int kMaxGradient = 60;  // of 255, so that one bright window does not dominate
constexpr double kNearest_m = 0.3, kFarthest_m = 6;

struct Pixel {
  int x, y;
};

std::vector<Pixel> depth_edges(const DepthImage& depth, double units_per_metre) {
  std::vector<Pixel> edges;
  const auto is_step = [&](int a, int b) {
    if (a == 0 || b == 0) return false;
    const double near = std::min(a, b) / units_per_metre;
    return near > kNearest_m && near < kFarthest_m && std::abs(a - b) > kMinStep * std::min(a, b);
  };
  for (int y = kReach_px; y + kReach_px < depth.height; ++y)
    for (int x = kReach_px; x + kReach_px < depth.width; ++x)
      if (is_step(depth.at(x - kReach_px, y), depth.at(x + kReach_px, y)) ||
          is_step(depth.at(x, y - kReach_px), depth.at(x, y + kReach_px)))
        edges.push_back({x, y});
  if (edges.size() <= kMaxEdgesPerFrame) return edges;
  std::vector<Pixel> some;
  for (std::size_t i = 0; i < kMaxEdgesPerFrame; ++i)
    some.push_back(edges[i * edges.size() / kMaxEdgesPerFrame]);
  return some;
}

Image<std::uint8_t> gradients(const ColorImage& color) {
  const auto grey = [&](int x, int y) {
    const Rgb8& pixel = color.at(x, y);
    return (pixel.r + 2 * pixel.g + pixel.b) / 4;
  };
  Image<std::uint8_t> gradient(color.width, color.height);
  for (int y = 1; y + 1 < color.height; ++y)
    for (int x = 1; x + 1 < color.width; ++x) {
      const int sum =
          std::abs(grey(x + 1, y) - grey(x - 1, y)) + std::abs(grey(x, y + 1) - grey(x, y - 1));
      gradient.at(x, y) = static_cast<std::uint8_t>(std::min(sum, kMaxGradient));
    }
  return gradient;
}

}  // namespace

bool RegistrationFit::is_doubtful() const {
  return gain >= kMinGain && worst_px >= kMinDisplacement_px;
}

void RegistrationCheck::add(const frame::RgbdFrame& frame, double depth_units_per_metre) {
  width_ = frame.depth.width;
  height_ = frame.depth.height;
  const std::vector<Pixel> edges = depth_edges(frame.depth, depth_units_per_metre);
  const Image<std::uint8_t> gradient = gradients(frame.color);
  edge_count_ += static_cast<std::int64_t>(edges.size());
  std::size_t at = 0;
  for (int s = 0; s < kScales; ++s) {
    const double scale = 1 + kScaleStep * (s - kScales / 2);
    std::vector<Pixel> scaled;
    for (const Pixel& edge : edges)
      scaled.push_back(
          {static_cast<int>(std::lround(scale * (edge.x - width_ * 0.5) + width_ * 0.5)),
           static_cast<int>(std::lround(scale * (edge.y - height_ * 0.5) + height_ * 0.5))});
    for (int j = 0; j < kShiftsY; ++j)
      for (int i = 0; i < kShiftsX; ++i) {
        Sum& sum = sums_[at++];
        const int dx = kShiftStep_px * (i - kShiftsX / 2), dy = kShiftStep_px * (j - kShiftsY / 2);
        for (const Pixel& edge : scaled) {
          const int x = edge.x + dx, y = edge.y + dy;
          if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
          sum.gradient += gradient.at(x, y);
          ++sum.count;
        }
      }
  }
}

std::optional<RegistrationFit> RegistrationCheck::fit() const {
  if (edge_count_ < kMinEdges) return std::nullopt;
  const auto mean = [](const Sum& sum) { return sum.gradient / static_cast<double>(sum.count); };
  const std::size_t middle =
      (static_cast<std::size_t>(kScales / 2) * kShiftsY + kShiftsY / 2) * kShiftsX + kShiftsX / 2;
  if (!(mean(sums_[middle]) > 0)) return std::nullopt;  // a black image
  std::size_t best = middle;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const bool enough =
        static_cast<double>(sums_[i].count) >= kMinInside * static_cast<double>(edge_count_);
    if (enough && mean(sums_[i]) > mean(sums_[best])) best = i;
  }
  const int place = static_cast<int>(best),
            scale_steps = place / (kShiftsX * kShiftsY) - kScales / 2;
  RegistrationFit fit;
  fit.scale = 1 + kScaleStep * scale_steps;
  fit.dx_px = kShiftStep_px * (place % kShiftsX - kShiftsX / 2);
  fit.dy_px = kShiftStep_px * (place / kShiftsX % kShiftsY - kShiftsY / 2);
  fit.gain = mean(sums_[best]) / mean(sums_[middle]);
  fit.worst_px = std::max(std::abs(fit.scale - 1) * width_ * 0.5 + std::abs(fit.dx_px),
                          std::abs(fit.scale - 1) * height_ * 0.5 + std::abs(fit.dy_px));
  return fit;
}

}  // namespace hermite::evaluate
