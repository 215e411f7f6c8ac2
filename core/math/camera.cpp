#include "core/math/camera.h"

#include <cmath>
#include <string>

namespace hermite {

namespace {

Error out_of_range(const std::string& field, double value, double low, double high) {
  return {ErrorCode::kInvalidArgument,
          "camera." + field + " is " + std::to_string(value) + ", allowed is " + std::to_string(low) + " to " + std::to_string(high)};
}

// Written so that NaN fails too.
Status validate_distortion(const Camera& camera) {
  for (const double u : {0.0, camera.width - 1.0})
    for (const double v : {0.0, camera.height - 1.0}) {
      const Eigen::Vector2d at((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
      const double moved_px = (camera.distortion.apply(at.x(), at.y()) - at).norm() * camera.fx;
      if (!(moved_px <= 0.25 * camera.width))
        return Error{ErrorCode::kInvalidArgument, "camera.distortion moves a corner of the image by " + std::to_string(moved_px) +
                                                      " pixels, allowed is a quarter of its width"};
    }
  return Done{};
}

bool within(double value, double low, double high) { return std::isfinite(value) && value >= low && value <= high; }

}  // namespace

Status validate(const Camera& camera) {
  struct Bound {
    const char* field;
    double value, low, high;
  };
  // Half the image side over the focal length is the tangent of half the field of view: 75 and 5 degrees.
  const double tan_widest = std::tan(75.0 * M_PI / 180.0), tan_narrowest = std::tan(5.0 * M_PI / 180.0);
  const Bound bounds[] = {
      {"width", static_cast<double>(camera.width), kMinImageSide_px, kMaxImageSide_px},
      {"height", static_cast<double>(camera.height), kMinImageSide_px, kMaxImageSide_px},
      {"fx", camera.fx, 0.5 * camera.width / tan_widest, 0.5 * camera.width / tan_narrowest},
      {"fy", camera.fy, 0.5 * camera.height / tan_widest, 0.5 * camera.height / tan_narrowest},
      {"cx", camera.cx, 0, camera.width - 1.0},
      {"cy", camera.cy, 0, camera.height - 1.0},
      {"depth_units_per_metre", camera.depth_units_per_metre, 1, 1e6},
  };
  for (const Bound& bound : bounds)
    if (!within(bound.value, bound.low, bound.high)) return out_of_range(bound.field, bound.value, bound.low, bound.high);
  return validate_distortion(camera);
}

}  // namespace hermite
