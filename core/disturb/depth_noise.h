// Noise models that turn noise-free depth into what a sensor would have measured. Deterministic in
// (seed, frame index, pixel), whatever the order of reading.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

enum class NoiseModel {
  kNone,
  kGaussian,  // z + sigma * n
  // The depth of a neighbour at a Gaussian offset of half a pixel; disparity f*b/z with f*b = 525 *
  // 0.075 px m, plus Gaussian noise of 1/18 px, rounded to 1 / steps_per_px; valid from 0.4 to 5 m.
  // The sensor compares blocks, so both Gaussians are means over 5x5 pixels of the image. With the
  // rounding to 1/8 px, which is white and 30 % of the variance, the correlation of the disparity
  // is 0.6, 0.43, 0.28 at 1, 2, 3 pixels, and 0 from 5 pixels on.
  kKinect,
  // The same variances, but every pixel is independent of its neighbours: averages out more easily
  // than for any sensor.
  kKinectWhite,
};

struct NoiseOptions {
  NoiseModel model = NoiseModel::kNone;
  double sigma_m = 0.003;  // for kGaussian, 0 to 0.2
  std::uint64_t seed = 1;
  // For the Kinects, 1 to 64: coarse depth has terraces that do not average out.
  double steps_per_px = 8;
  bool operator==(const NoiseOptions&) const = default;
};

// Parses "none", "gaussian", "kinect" or "kinect-white" with other options as "key=value" separated
// by commas, as in "gaussian,sigma_mm=6,seed=2" or "kinect,steps_per_px=4". kInvalidArgument,
// naming key and range.
Result<NoiseOptions> parse_noise(const std::string& text);

// 0 stays 0; a value outside the range of the model or the image becomes 0. The scale of the values
// is the camera's.
DepthImage add_noise(const DepthImage& depth, const Camera& camera, const NoiseOptions& options,
                     std::int64_t frame_index);

// Returns the same sequence with noise on its depth; everything else, including the name, is
// unchanged. kNone returns the original. Users append it to any source:
// "living_room_part+noise=kinect,seed=3" (open_sequence).
std::unique_ptr<dataset::Sequence> with_noise(std::unique_ptr<dataset::Sequence> sequence,
                                              const NoiseOptions& options);

}  // namespace hermite::disturb
