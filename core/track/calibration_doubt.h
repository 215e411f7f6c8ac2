// Whether the camera's calibration fits its measurements. Plain values, any thread.
#pragma once

#include <string>

namespace hermite::track {

// An error of the camera counts as known from so many of its standard deviations on.
inline constexpr double kKnownSigmas = 5;

// Errors of a camera that were found elsewhere and are certain; 0: none.
struct CertainErrors {
  double focal = 0;     // share by which the stated focal length is too large
  double k1 = 0;        // error of the stated Distortion::k1
  double timing_s = 0;  // the largest error of the stated ImageTiming
  bool operator==(const CertainErrors&) const = default;
};

// Saves or restores them.
template <class Bytes, class Errors>
void certain_errors_fields(Bytes& bytes, Errors& errors) {
  bytes.number(errors.focal);
  bytes.number(errors.k1);
  bytes.number(errors.timing_s);
}

// What contradicts the camera's calibration.
struct CalibrationDoubt {
  // Share by which depth in the corners of the image is too large, and its standard deviation.
  double bend = 0, deviation = 0;
  CertainErrors certain = {};
  // Returns a text if the measurements certainly contradict the calibration; empty otherwise.
  std::string reason() const;
};

}  // namespace hermite::track
