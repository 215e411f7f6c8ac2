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
  if (certain.focal != 0) return no_fit + "its focal length is" + by_about(certain.focal);
  char text[96];
  if (certain.k1 != 0) {
    std::snprintf(text, sizeof text, "the distortion of its lens, k1, is too %s by about %.3f",
                  certain.k1 > 0 ? "great" : "small", std::abs(certain.k1));
    return no_fit + text;
  }
  if (certain.timing_s == 0) return "";
  std::snprintf(text, sizeof text,
                "the time at which rows of its images are taken is wrong by about %.0f ms",
                1e3 * certain.timing_s);
  return no_fit + text;
}

}  // namespace hermite::track
