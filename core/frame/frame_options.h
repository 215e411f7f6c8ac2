// Options of frame preprocessing. The key and the reason of each default are in
// core/pipeline/options.cpp.
#pragma once

#include <algorithm>

namespace hermite::frame {

// Standard deviation of a Kinect v1 depth at z: floor + growth (z - 0.4 m)^2 (Nguyen, Izadi, Lovell
// 2012).
inline constexpr double kKinectNoiseFloor_m = 0.0012, kKinectNoiseGrowth_per_m = 0.0019;
inline double kinect_noise_m(double depth_m) {
  const double beyond_m = std::max(0.0, depth_m - 0.4);
  return kKinectNoiseFloor_m + kKinectNoiseGrowth_per_m * beyond_m * beyond_m;
}

struct FrameOptions {
  double depth_min_m = 0.3;
  double depth_max_m = 5.0;
  int sampling = 2;
  double bilateral_sigma_space_px = 2.25;
  double bilateral_correlated_space_px = 4.0;
  double bilateral_noise_sigmas = 2.0;
  bool measure_noise = true;
  // Those of a Kinect v1, until the noise is measured.
  double noise_floor_m = kKinectNoiseFloor_m;
  double noise_growth_per_m = kKinectNoiseGrowth_per_m;
  double support_radius_scale = 2.5;
  double depth_gate_m = 0.1;
  double curvature_limit_per_m = 300;
  double confidence_epsilon = 1000;
  bool hrbf_confidence = true;
  bool project_to_surface = true;
  bool correct_camera = true;
};

}  // namespace hermite::frame
