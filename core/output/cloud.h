// The reconstructed model as points. Plain values.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/image.h"

namespace hermite::output {

struct CloudPoint {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit length, towards the camera that saw it
  Rgb8 color;
  float confidence = 0;
  float curvature_max_per_m = 0, curvature_min_per_m = 0;
  float radius_m = 0;
  std::uint32_t submap = 0;
};
// In the order of the model's slots, which is the same in every run.
using Cloud = std::vector<CloudPoint>;

// Returns the confidence as viewers get it: 8 times its value, rounded, at most 255. It must not be
// NaN.
inline std::uint8_t eighths_of_confidence(float confidence) {
  return static_cast<std::uint8_t>(std::clamp(std::round(confidence * 8.0f), 0.0f, 255.0f));
}

// A changed slot of the model. A slot keeps its number while its surfel lives and is reused
// afterwards.
struct SlotChange {
  std::uint32_t slot = 0;
  bool alive = false;  // false: the surfel was removed, and `point` has no meaning
  CloudPoint point;    // in the frame of its submap
};

}  // namespace hermite::output
