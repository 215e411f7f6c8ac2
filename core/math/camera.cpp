#include "core/math/camera.h"

#include <fmt/core.h>

#include <cmath>
#include <string>

namespace hermite {

namespace {

// Tolerance for the length of a quaternion: the precision of text with four digits.
constexpr double kUnitTolerance = 1e-3;

struct Bound {
  const char* field;
  double value, low, high;
};

// Written so that NaN fails as well.
bool is_within(const Bound& bound) {
  return std::isfinite(bound.value) && bound.value >= bound.low && bound.value <= bound.high;
}

// `owner` is "camera." or "camera.color.".
Error out_of_range(const std::string& owner, const Bound& bound) {
  return {ErrorCode::kInvalidArgument,
          fmt::format("{}{} is {:f}, allowed is {:f} to {:f}", owner, bound.field, bound.value,
                      bound.low, bound.high)};
}

struct Lens {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels
  Distortion distortion;
};

Status validate_distortion(const std::string& owner, const Lens& lens, int width, int height) {
  for (const double u : {0.0, width - 1.0})
    for (const double v : {0.0, height - 1.0}) {
      const Eigen::Vector2d at((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy);
      const double moved_px = (lens.distortion.apply(at.x(), at.y()) - at).norm() * lens.fx;
      if (!(moved_px <= 0.25 * width))
        return Error{ErrorCode::kInvalidArgument,
                     fmt::format("{}distortion moves a corner of the image by {:f} pixels, allowed "
                                 "is a quarter of its width",
                                 owner, moved_px)};
    }
  return Done{};
}

Status validate_lens(const std::string& owner, const Lens& lens, int width, int height) {
  // Half the image side over the focal length is the tangent of half the field of view: 75 and 5
  // degrees.
  const double tan_widest = std::tan(75.0 * M_PI / 180.0),
               tan_narrowest = std::tan(5.0 * M_PI / 180.0);
  const Bound bounds[] = {
      {"fx", lens.fx, 0.5 * width / tan_widest, 0.5 * width / tan_narrowest},
      {"fy", lens.fy, 0.5 * height / tan_widest, 0.5 * height / tan_narrowest},
      {"cx", lens.cx, 0, width - 1.0},
      {"cy", lens.cy, 0, height - 1.0},
  };
  for (const Bound& bound : bounds)
    if (!is_within(bound)) return out_of_range(owner, bound);
  return validate_distortion(owner, lens, width, height);
}

Status validate_color(const ColorCamera& color, int width, int height) {
  const Status lens = validate_lens(
      "camera.color.", {color.fx, color.fy, color.cx, color.cy, color.distortion}, width, height);
  if (!lens.ok()) return lens.error();
  const Bound bounds[] = {
      {"color_from_depth.rotation's length", color.color_from_depth.rotation.norm(),
       1 - kUnitTolerance, 1 + kUnitTolerance},
      {"color_from_depth.translation's length in metres", color.color_from_depth.translation.norm(),
       0, kMaxColorBaseline_m},
  };
  for (const Bound& bound : bounds)
    if (!is_within(bound)) return out_of_range("camera.color.", bound);
  return Done{};
}

}  // namespace

bool ColorCamera::operator==(const ColorCamera& other) const {
  const auto same = [](const Rigid3& a, const Rigid3& b) {
    return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
  };
  return fx == other.fx && fy == other.fy && cx == other.cx && cy == other.cy &&
         distortion == other.distortion && same(color_from_depth, other.color_from_depth);
}

Camera rectified(const Camera& camera) {
  Camera pinhole = camera;
  pinhole.distortion = {};
  pinhole.color.reset();
  pinhole.depth_correction = {};
  pinhole.timing = {};
  return pinhole;
}

Status validate(const Camera& camera) {
  const Bound sides[] = {
      {"width", static_cast<double>(camera.width), kMinImageSide_px, kMaxImageSide_px},
      {"height", static_cast<double>(camera.height), kMinImageSide_px, kMaxImageSide_px},
  };
  for (const Bound& side : sides)
    if (!is_within(side)) return out_of_range("camera.", side);
  const Status lens =
      validate_lens("camera.", {camera.fx, camera.fy, camera.cx, camera.cy, camera.distortion},
                    camera.width, camera.height);
  if (!lens.ok()) return lens.error();
  const Bound rest[] = {
      {"depth_units_per_metre", camera.depth_units_per_metre, 1, 1e6},
      {"depth_correction.bend", camera.depth_correction.bend, -kMaxBend, kMaxBend},
      {"depth_correction.inverse_offset_per_m", camera.depth_correction.inverse_offset_per_m,
       -kMaxInverseOffset_per_m, kMaxInverseOffset_per_m},
      {"timing.depth_readout_s", camera.timing.depth_readout_s, -kMaxReadout_s, kMaxReadout_s},
      {"timing.color_readout_s", camera.timing.color_readout_s, -kMaxReadout_s, kMaxReadout_s},
      {"timing.color_delay_s", camera.timing.color_delay_s, -kMaxColorDelay_s, kMaxColorDelay_s},
      {"standard_deviations.bend", camera.deviations.bend, 0, kMaxCameraDeviation},
      {"standard_deviations.focal", camera.deviations.focal, 0, kMaxCameraDeviation},
      {"standard_deviations.k1", camera.deviations.k1, 0, kMaxCameraDeviation},
  };
  for (const Bound& bound : rest)
    if (!is_within(bound)) return out_of_range("camera.", bound);
  if (camera.color) return validate_color(*camera.color, camera.width, camera.height);
  return Done{};
}

}  // namespace hermite
