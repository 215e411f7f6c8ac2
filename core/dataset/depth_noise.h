// Noise models for depth without noise: what a sensor would have measured. Deterministic in (seed, frame index, pixel), whatever the order
// of reading.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite {

enum class NoiseModel {
  kNone,
  kGaussian,  // z + sigma * n
  kKinect,  // a neighbour's depth at a Gaussian offset of half a pixel; disparity f*b/z with f*b = 525 * 0.075 px m, plus Gaussian 1/18 px,
            // rounded to 1/8 px; valid from 0.4 to 5 m
};

struct NoiseOptions {
  NoiseModel model = NoiseModel::kNone;
  double sigma_m = 0.003;  // of kGaussian, 0 to 0.2
  std::uint64_t seed = 1;
  bool operator==(const NoiseOptions&) const = default;
};

// "none", "kinect" or "gaussian" and the other options as "key=value" separated by commas: "gaussian,sigma_mm=6,seed=2".
// kInvalidArgument, naming key and range.
Result<NoiseOptions> parse_noise(const std::string& text);

// 0 stays 0; a value pushed out of the model's or the image's range becomes 0. The scale of the values is the camera's.
DepthImage add_noise(const DepthImage& depth, const Camera& camera, const NoiseOptions& options, std::int64_t frame_index);

// The same sequence with noise on its depth; everything else, name included, is unchanged. kNone gives the sequence back.
// Users write it behind any source: "living_room_part+noise=kinect,seed=3" (open_sequence).
std::unique_ptr<Sequence> with_noise(std::unique_ptr<Sequence> sequence, const NoiseOptions& options);

}  // namespace hermite
