#include "core/evaluate/depth_doubts.h"

#include <fmt/core.h>

namespace hermite::evaluate {
namespace {

// Share of valid pixels; below this, a Kinect saw a window or was too near.
constexpr double kLittleDepth = 0.3;
constexpr double kNearestSensor_m = 0.2, kFarthestSensor_m = 12;

}  // namespace

std::vector<std::string> depth_doubts(const DepthFindings& found) {
  std::vector<std::string> doubts;
  if (found.unit.is_doubtful) doubts.push_back("depth unit: " + found.unit.reason);
  if (found.survey.valid_share < kLittleDepth)
    doubts.push_back(
        fmt::format("only {:.0f} % of the pixels have depth", 100 * found.survey.valid_share));
  const double near_m = found.survey.nearest / found.units_per_metre,
               far_m = found.survey.farthest / found.units_per_metre;
  if (found.survey.median > 0 && (near_m < kNearestSensor_m || far_m > kFarthestSensor_m))
    doubts.push_back(
        fmt::format("depth from {:.2f} to {:.2f} m is more than a camera of rooms measures: the "
                    "unit may be wrong, or a value stands for no measurement",
                    near_m, far_m));
  if (const auto& fit = found.registration; fit && fit->is_doubtful())
    doubts.push_back(
        fmt::format("depth does not seem to be registered to colour: its edges lie {:.2f} times "
                    "better on the image's when scaled by {:.2f} and moved by ({}, {}) pixels; see "
                    "color_camera in the README",
                    fit->gain, fit->scale, fit->dx_px, fit->dy_px));
  return doubts;
}

}  // namespace hermite::evaluate
