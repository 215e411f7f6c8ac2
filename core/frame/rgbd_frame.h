// An RGB-D pair from a sensor or a recording. Both images have the same size, and depth is
// registered to colour unless the camera has a Camera::color. Plain value.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/base/image.h"

namespace hermite::frame {

struct RgbdFrame {
  double timestamp_s = 0;  // in the clock of the recording
  DepthImage depth;        // sensor units, see Camera::depth_units_per_metre
  ColorImage color;
  // What the camera's accelerometer felt since the frame before, as a mean in the camera frame of
  // the poses: at rest it points up and has 9.8. Nullopt without one. Any value: FeltGravity judges
  // it.
  std::optional<Eigen::Vector3d> acceleration_m_s2{};
};

}  // namespace hermite::frame
