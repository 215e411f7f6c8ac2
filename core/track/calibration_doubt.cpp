#include "core/track/calibration_doubt.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace hermite::track {

namespace {

// A bend is reported if it is at least this large and exceeds this many standard deviations.
constexpr double kLeastBend = 0.008, kDoubtSigmas = 5;

}  // namespace

std::string CalibrationDoubt::reason() const {
  const auto by_about = [](double off) {
    char text[48];
    std::snprintf(text, sizeof text, " too %s by about %.1f %%", off > 0 ? "great" : "small",
                  100 * std::abs(off));
    return std::string(text);
  };
  const std::string no_fit = "the camera's calibration does not fit: ";
  if (std::abs(bend) >= std::max(kLeastBend, kDoubtSigmas * deviation))
    return no_fit + "depth in the corners of the image is" + by_about(bend);
  if (focal != 0) return no_fit + "its focal length is" + by_about(focal);
  if (timing_s == 0) return "";
  char text[96];
  std::snprintf(text, sizeof text,
                "the time at which rows of its images are taken is wrong by about %.0f ms",
                1e3 * timing_s);
  return no_fit + text;
}

}  // namespace hermite::track
