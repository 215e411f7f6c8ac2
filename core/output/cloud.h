// The reconstructed model as points, for files and viewers. Plain values.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/image.h"

namespace hermite {

struct CloudPoint {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, towards the camera that saw it
  Rgb8 color;
  float confidence = 0;
  float curvature_max_per_m = 0, curvature_min_per_m = 0;
  float radius_m = 0;
  std::uint32_t submap = 0;
};
using Cloud = std::vector<CloudPoint>;  // in the order of the model's slots: the same run gives the same order

// One slot of the model that changed. Slots keep their number for as long as their surfel lives and are used again afterwards.
struct SlotChange {
  std::uint32_t slot = 0;
  bool alive = false;  // false: the surfel is gone and `point` is meaningless
  CloudPoint point;    // in the frame of its submap
};

}  // namespace hermite
