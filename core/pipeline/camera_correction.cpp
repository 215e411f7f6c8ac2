#include "core/pipeline/camera_correction.h"

#include <fmt/core.h>

#include <cstdio>

namespace hermite::pipeline {

std::string camera_correction_message(const Camera& given, const Camera& corrected) {
  std::string changes;
  const auto add = [&changes](const char* what, double change, const char* unit) {
    if (change == 0) return;
    char number[32];
    const bool is_bare = unit[0] == '\0', is_share = unit[0] == '%';
    std::snprintf(number, sizeof number,
                  is_bare    ? "%+.3f"
                  : is_share ? "%+.2f "
                             : "%+.1f ",
                  change);
    changes += fmt::format("{}{} by {}{}", changes.empty() ? "" : ", ", what, number, unit);
  };
  const ImageTiming &before = given.timing, &after = corrected.timing;
  add("focal length", 100 * (corrected.fx / given.fx - 1), "%");
  add("distortion of the lens (k1)", corrected.distortion.k1 - given.distortion.k1, "");
  add("depth in the corners of the image",
      100 * (corrected.depth_correction.bend - given.depth_correction.bend), "%");
  add("readout of depth", 1e3 * (after.depth_readout_s - before.depth_readout_s), "ms");
  add("readout of colour", 1e3 * (after.color_readout_s - before.color_readout_s), "ms");
  add("delay of colour", 1e3 * (after.color_delay_s - before.color_delay_s), "ms");
  return "the camera's calibration was off and is corrected: " + changes;
}

}  // namespace hermite::pipeline
