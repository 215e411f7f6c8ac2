#include "core/evaluate/depth_doubts.h"

#include "core/base/printf_text.h"

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
    doubts.push_back("only " + printf_text("%.0f %%", 100 * found.survey.valid_share) +
                     " of the pixels have depth");
  const double near_m = found.survey.nearest / found.units_per_metre,
               far_m = found.survey.farthest / found.units_per_metre;
  if (found.survey.median > 0 && (near_m < kNearestSensor_m || far_m > kFarthestSensor_m))
    doubts.push_back("depth from " + printf_text("%.2f", near_m) + " to " +
                     printf_text("%.2f m", far_m) +
                     " is more than a camera of rooms measures: the unit may be wrong, or a value "
                     "stands for no measurement");
  if (const auto& fit = found.registration; fit && fit->is_doubtful())
    doubts.push_back(
        "depth does not seem to be registered to colour: its edges lie " +
        printf_text("%.2f", fit->gain) + " times better on the image's when scaled by " +
        printf_text("%.2f", fit->scale) + " and moved by (" + std::to_string(fit->dx_px) + ", " +
        std::to_string(fit->dy_px) + ") pixels; see color_camera in the README");
  return doubts;
}

}  // namespace hermite::evaluate
