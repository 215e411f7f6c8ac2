#include "core/frame/rectify.h"

#include <algorithm>
#include <cmath>

#include "core/frame/color_between.h"
#include "core/math/depth_between.h"

namespace hermite::frame {

Rectifier::Rectifier(const Camera& camera) : camera_(camera) {
  if (camera.color) registration_.emplace(camera);
  if (camera.distortion == Distortion{}) return;
  sources_.reserve(static_cast<std::size_t>(camera.width) *
                   static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d at = camera.distort(x, y);
      // Clamps positions far outside, so that a cast to whole pixels stays in range.
      const auto pixel = [](double value, int side) {
        return static_cast<float>(std::clamp(value, -2.0, side + 1.0));
      };
      sources_.push_back({pixel(at.x(), camera.width), pixel(at.y(), camera.height)});
    }
}

DepthImage Rectifier::straight(const DepthImage& depth) const {
  if (sources_.empty()) return depth;
  DepthImage straight(depth.width, depth.height);
  for (std::size_t i = 0; i < sources_.size(); ++i)
    straight.pixels[i] = depth_between(depth, double{sources_[i].x}, double{sources_[i].y});
  return straight;
}

ColorImage Rectifier::straight(const ColorImage& color) const {
  if (sources_.empty()) return color;
  ColorImage straight(color.width, color.height);
  for (std::size_t i = 0; i < sources_.size(); ++i)
    straight.pixels[i] = color_between(color, sources_[i].x, sources_[i].y);
  return straight;
}

void Rectifier::correct(DepthImage& depth) const {
  if (camera_.depth_correction == DepthCorrection{}) return;
  const double units = camera_.depth_units_per_metre;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      std::uint16_t& pixel = depth.at(x, y);
      if (pixel == 0) continue;
      const double corrected = std::round(
          camera_.depth_correction.true_depth_m(pixel / units, camera_.rho2(x, y)) * units);
      pixel = corrected <= 65535 ? static_cast<std::uint16_t>(corrected) : std::uint16_t{0};
    }
}

RgbdFrame Rectifier::apply(const RgbdFrame& frame) const {
  RgbdFrame rectified{frame.timestamp_s, straight(frame.depth), {}, frame.acceleration_m_s2};
  correct(rectified.depth);
  rectified.color =
      registration_ ? registration_->apply(frame.color, rectified.depth) : straight(frame.color);
  return rectified;
}

std::optional<Rectifier> rectifier_of(const Camera& camera) {
  if (camera.distortion == Distortion{} && camera.depth_correction == DepthCorrection{} &&
      !camera.color)
    return std::nullopt;
  return Rectifier(camera);
}

}  // namespace hermite::frame
