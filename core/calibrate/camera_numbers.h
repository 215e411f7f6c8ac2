// The camera parameters that calibration may change. Plain values, pure functions.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "core/calibrate/image_timing.h"
#include "core/math/camera.h"

namespace hermite {

// In the order of all vectors and matrices of parameters.
enum CameraNumber : std::size_t {
  kFocal,          // logarithm of a common factor of fx and fy
  kCenterX,        // added to cx [px]
  kCenterY,        // added to cy [px]
  kBend,           // added to DepthCorrection::bend
  kInverseOffset,  // added to DepthCorrection::inverse_offset_per_m
  kDepthReadout,   // ImageTiming::depth_readout_s
  kColorReadout,   // ImageTiming::color_readout_s
  kColorDelay,     // ImageTiming::color_delay_s
  kCameraNumberCount,
};
using CameraVector = Eigen::Matrix<double, kCameraNumberCount, 1>;

inline bool is_timing(std::size_t number) { return number >= kDepthReadout; }

struct TrialCamera {
  Camera camera;
  ImageTiming timing{};
};
TrialCamera changed(const Camera& camera, const CameraVector& change);

}  // namespace hermite
