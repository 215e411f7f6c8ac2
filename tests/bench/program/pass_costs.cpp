#include "tests/bench/program/pass_costs.h"

#include <algorithm>
#include <cmath>

namespace hermite::bench {

namespace {

// Where a word is four bytes, an array of pixels with one is 4 bytes a pixel.
constexpr double kWord = 4;
// position and confidence; normal, radius, submap, colour, curvatures; times.
constexpr double kPosition = 16, kAttributes = 16, kTimes = 8;

PassCost whole_buffers(const std::string& pass, double flops_per_invocation) {
  return {pass, 0, flops_per_invocation, 1, 0};
}

// The images that the odometry binds have `words` words a pixel, and its sums are small beside
// them.
PassCost by_pixel(const std::string& pass, double words, double flops_per_pixel) {
  return {pass, 0, 0, 1, flops_per_pixel / (words * kWord)};
}

double bilateral_flops(const frame::FrameOptions& options) {
  const double side = 2 * std::round(options.bilateral_sigma_space_px * 4 / 3) + 1;
  // Four pixels an invocation: difference, squares, exponential, two sums.
  return 4 * 9 * side * side;
}

// Four pixels an invocation: a step to the surface and the field with its Hessian over 7 rows of 10
// kernels, then curvatures.
double surface_flops(const frame::FrameOptions& options) {
  return 70 * ((options.project_to_surface ? 127 : 0) + 434) + 4 * 120;
}

// Likewise: steps along the ray (the last one corrects the bias) and the field with its gradient.
double predict_flops(const map::MapOptions& options) {
  const double kernels = options.window * (options.window + 3);
  return options.hrbf_prediction ? kernels * (153 * (options.max_iterations + 1) + 163)
                                 : 4 * options.window * options.window * 40;
}

}  // namespace

std::vector<PassCost> pass_costs(const pipeline::Options& options) {
  // Of a pixel of a surface: depth, normal, curvatures, weight, intensity.
  const double surface_pixel = 5 * kWord;
  return {
      whole_buffers("frame/inverse_depth", 8 * 2),
      whole_buffers("frame/bilateral", bilateral_flops(options.frame)),
      whole_buffers("frame/normals", 63),
      whole_buffers("frame/surface", surface_flops(options.frame)),
      whole_buffers("frame/intensity", 71),
      whole_buffers("frame/gradient", 12),
      whole_buffers("frame/downsample", 75),
      // Depth, normals, curvatures, intensity, gradients of the frame and five of the prediction.
      // Transform, gates, two rows of equations; the search around the projection, which is off by
      // default, is not counted.
      by_pixel("track/odometry", 10, 345),
      by_pixel("track/rotation", 2, 95),
      by_pixel("track/agreement", 5, 75),
      // Slot, depth and times; the four words of them.
      {"map/index_times", 2 * kWord + kTimes + 4 * kWord, 0},
      // Its slot, the surfel there; the kernel.
      {"map/kernels", kWord + kPosition + kAttributes + 4 * kWord, 75},
      // Its slot, the surfel there; the cell.
      {"map/index_surfel", 2 * kWord + kPosition + kAttributes + 4 * kWord, 70},
      // The pixel's measurement, its cell of the index map; candidate and claim.
      {"map/associate", 3 * kWord + 4 * kWord + 2 * kWord, 500},
      // Candidate, claim, cell, the measurement, the surfel read and written.
      {"map/merge", 3 * kWord + 6 * kWord + 2 * (kPosition + kAttributes) + kTimes, 150},
      // 32 pixels: their word.
      {"map/list_new", kWord, 0},
      // Four pixels: kernel, slot, surfel, the pixel of the prediction.
      {"map/predict", 4 * (4 * kWord + kWord + kPosition + kAttributes + surface_pixel),
       predict_flops(options.map)},
      {"(fill)", 0, 0, 1, 0},
      {"(copy)", 0, 0, 1, 0},
  };
}

PassBound bound_of(const Timeline::Pass& pass, const std::vector<PassCost>& costs,
                   const Roofline& roofline) {
  const auto cost = std::find_if(costs.begin(), costs.end(),
                                 [&pass](const PassCost& c) { return c.pass == pass.name; });
  if (cost == costs.end()) return {};
  const auto invocations = static_cast<double>(pass.invocations),
             within_reach = static_cast<double>(pass.bytes_within_reach);
  const double bytes =
      cost->bytes_per_invocation * invocations + cost->bytes_per_byte * within_reach;
  const double flops =
      cost->flops_per_invocation * invocations + cost->flops_per_byte * within_reach;
  return {bytes / roofline.memory_gb_per_s * 1e-6, flops / roofline.gflop_per_s * 1e-6};
}

}  // namespace hermite::bench
