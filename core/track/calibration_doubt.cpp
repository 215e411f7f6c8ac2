#include "core/track/calibration_doubt.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace hermite::track {

namespace {

// A bend is reported only if it is at least this large.
constexpr double kLeastBend = 0.008;

}  // namespace

std::string CalibrationDoubt::reason() const {
  const auto by_about = [](double off) {
    return fmt::format("too {} by about {:.1f} %", off > 0 ? "great" : "small",
                       100 * std::abs(off));
  };
  const std::string no_fit = "the camera's calibration does not fit:";
  if (std::abs(bend) >= std::max(kLeastBend, kKnownSigmas * deviation))
    return fmt::format("{} depth in the corners of the image is {}", no_fit, by_about(bend));
  if (certain.focal != 0)
    return fmt::format("{} its focal length is {}", no_fit, by_about(certain.focal));
  if (certain.k1 != 0)
    return fmt::format("{} the distortion of its lens, k1, is too {} by about {:.3f}", no_fit,
                       certain.k1 > 0 ? "great" : "small", std::abs(certain.k1));
  if (certain.timing_s == 0) return "";
  return fmt::format(
      "{} the time at which rows of its images are taken is wrong by about {:.0f} ms", no_fit,
      1e3 * certain.timing_s);
}

}  // namespace hermite::track
