// Options of camera tracking. The key and the reason of each default are in
// core/pipeline/options.cpp.
#pragma once

namespace hermite::track {

struct TrackOptions {
  bool rotation_prealignment = true;
  bool constant_velocity = true;
  double geometric_weight = 100000.0;
  bool discount_normal_noise = true;
  double photometric_sigma = 200.0;
  double photometric_gate = 3.0;
  double mature_confidence = 20.0 / 256.0;
  double distance_gate_m = 0.10;
  double normal_gate_deg = 20.0;
  double photometric_depth_gate_m = 0.07;
  bool dissimilarity_search = false;
  int max_iterations_coarse = 4;
  int max_iterations_middle = 5;
  int max_iterations_fine = 10;
  double max_step_m = 0.3;
  double min_surface_ratio = 0.01;
  double min_agreement = 0.6;
  double min_overlap = 0.2;
  double min_correlation = 0.3;
  bool object = false;
};

}  // namespace hermite::track
