// Whether the camera's calibration fits its measurements. Plain values, any thread.
#pragma once

#include <string>

namespace hermite::track {

// What contradicts the camera's calibration.
struct CalibrationDoubt {
  // Share by which depth in the corners of the image is too large, and its standard deviation.
  double bend = 0, deviation = 0;
  double focal = 0;     // share by which the stated focal length is too large, once that is certain
  double timing_s = 0;  // the largest error of the stated ImageTiming, once that is certain
  // Returns a text if the measurements certainly contradict the calibration; empty otherwise.
  std::string reason() const;
};

}  // namespace hermite::track
