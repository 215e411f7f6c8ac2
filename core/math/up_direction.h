// Which way is up in a world whose axes are those of its first camera. Plain value.
#pragma once

#include <Eigen/Core>

namespace hermite {

struct UpDirection {
  Eigen::Vector3d in_world{0, -1, 0};  // of unit length
  double sigma_rad = 0;                // standard deviation of its angle about any level axis
};

}  // namespace hermite
