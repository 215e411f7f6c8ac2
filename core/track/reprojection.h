// Terms that followed corners add to a Gauss-Newton system. Pure functions of values. Any thread.
#pragma once

#include "core/math/camera.h"
#include "core/track/normal_equations.h"

namespace hermite::track {

// Adds the two rows of one corner to the system of a step frame_from_earlier <- exp(x)
// frame_from_earlier. `point` is the corner in the frame's camera frame [m], in front of the
// camera; `error_px` is its projection minus its measured position; `weight` is in 1/px^2.
inline void add_reprojection(NormalEquations& system, const Camera& camera,
                             const Eigen::Vector3d& point, const Eigen::Vector2d& error_px,
                             double weight) {
  const double per_z = 1 / point.z(), x = point.x() * per_z, y = point.y() * per_z;
  const Vector6d u = camera.fx * Vector6d{per_z, 0, -x * per_z, -x * y, 1 + x * x, -y};
  const Vector6d v = camera.fy * Vector6d{0, per_z, -y * per_z, -(1 + y * y), x * y, x};
  const Vector6d weighted_u = weight * u, weighted_v = weight * v;
  for (int column = 0; column < 6; ++column) {
    system.hessian.col(column) += weighted_u * u[column];
    system.hessian.col(column) += weighted_v * v[column];
  }
  system.right_hand_side.noalias() -= error_px.x() * weighted_u;
  system.right_hand_side.noalias() -= error_px.y() * weighted_v;
}

// Returns the prior of a motion: independent standard deviations of its translation [m] and its
// rotation [rad].
inline NormalEquations motion_prior(double translation_m, double rotation_rad) {
  NormalEquations system;
  system.hessian.diagonal().head<3>().setConstant(1 / (translation_m * translation_m));
  system.hessian.diagonal().tail<3>().setConstant(1 / (rotation_rad * rotation_rad));
  return system;
}

}  // namespace hermite::track
