// Options of prediction, fusion and cleaning. The key and the reason of each default are in
// core/pipeline/options.cpp.
#pragma once

namespace hermite::map {

struct MapOptions {
  double stable_confidence = 3.0;
  double max_confidence = 100.0;
  bool hrbf_prediction = true;
  bool correct_bias = true;
  int window = 5;
  bool curvature_weight = false;
  double curvature_lambda_per_m = 10.0;
  double confidence_scale = 1.0 / 256.0;
  int min_support = 7;
  int max_iterations = 2;
  double fill_in_below = 0.75;
  double fuse_depth_gate_m = 0.05;
  double fuse_normal_gate_rad = 0.5;
  bool fuse_surface = true;
  bool weigh_by_radius = true;
  int clean_interval_frames = 4;
  int max_unstable_age_frames = 200;
  double redundancy_depth_m = 0.01;
  int gpu_memory_mb = 0;
};

}  // namespace hermite::map
