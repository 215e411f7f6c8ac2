// The camera parameters that calibration may change. Plain values, pure functions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/math/camera.h"

namespace hermite::calibrate {

// Indices of the parameters in every vector and matrix.
enum CameraNumber : std::size_t {
  kFocal,          // logarithm of a common factor of fx and fy
  kCenterX,        // added to cx [px]
  kCenterY,        // added to cy [px]
  kRadial,         // added to Distortion::k1
  kBend,           // added to DepthCorrection::bend
  kInverseOffset,  // added to DepthCorrection::inverse_offset_per_m
  kDepthReadout,   // added to ImageTiming::depth_readout_s
  kColorReadout,   // added to ImageTiming::color_readout_s
  kColorDelay,     // added to ImageTiming::color_delay_s
  kCameraNumberCount,
};
// Number of the timing parameters, which come last.
inline constexpr std::size_t kTimingNumberCount = kCameraNumberCount - kDepthReadout;
using CameraVector = Eigen::Matrix<double, kCameraNumberCount, 1>;
using FreeNumbers = std::array<bool, kCameraNumberCount>;  // whether each parameter may change

// Whether depth and colour, as received, are seen through the same lens. Of a camera with two, the
// distortion cannot be found: registered images do not tell which of them is distorted.
enum class Lenses { kOne, kTwo };

inline bool is_timing(std::size_t number) { return number >= kDepthReadout; }

// Returns the camera with this change of its parameters.
inline Camera changed(Camera camera, const CameraVector& change) {
  camera.fx *= std::exp(change[kFocal]);
  camera.fy *= std::exp(change[kFocal]);
  camera.cx += change[kCenterX];
  camera.cy += change[kCenterY];
  camera.distortion.k1 += change[kRadial];
  camera.depth_correction.bend += change[kBend];
  camera.depth_correction.inverse_offset_per_m += change[kInverseOffset];
  camera.timing.depth_readout_s += change[kDepthReadout];
  camera.timing.color_readout_s += change[kColorReadout];
  camera.timing.color_delay_s += change[kColorDelay];
  return camera;
}

}  // namespace hermite::calibrate
