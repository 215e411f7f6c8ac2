// Converts from the axes, unit and origin of a file to the world frame of a scan. Pure.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/import/model.h"
#include "core/output/axes.h"

namespace hermite::imports {

inline Eigen::Vector3f turned_from(UpAxis up, const Eigen::Vector3f& v) {
  return up == UpAxis::kY ? output::from_y_up(v) : up == UpAxis::kZ ? output::from_z_up(v) : v;
}

inline Eigen::Vector3f unit_or_zero(const Eigen::Vector3f& normal) {
  const float length = normal.stableNorm();
  return length > 0 && std::isfinite(length) ? Eigen::Vector3f(normal / length)
                                             : Eigen::Vector3f::Zero();
}

}  // namespace hermite::imports
