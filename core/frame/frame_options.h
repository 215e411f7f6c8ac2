// How a depth frame becomes surface maps. Values; each has its key and reason in core/pipeline/options.cpp.
#pragma once

namespace hermite {

struct FrameOptions {
  double depth_min_m = 0.3;
  double depth_max_m = 5.0;
  int sampling = 2;
  double bilateral_sigma_space_px = 2.25;
  double bilateral_correlated_space_px = 4.0;
  double bilateral_noise_sigmas = 2.0;
  bool measure_noise = true;
  // Standard deviation of a Kinect v1 depth at z: floor + growth (z - 0.4 m)^2 (Nguyen, Izadi, Lovell 2012).
  double noise_floor_m = 0.0012;
  double noise_growth_per_m = 0.0019;
  double support_radius_scale = 2.5;
  double depth_gate_m = 0.1;
  double curvature_limit_per_m = 300;
  double confidence_epsilon = 1000;
  bool hrbf_confidence = true;
  bool project_to_surface = true;
  bool correct_camera = true;
};

}  // namespace hermite
