#include "core/track/twist_covariance.h"

namespace hermite::track {

Matrix6d at_camera(const Eigen::Vector3d& position_world) {
  Matrix6d change = Matrix6d::Identity();
  change.topRightCorner<3, 3>() = -skew(position_world);
  return change;
}

Matrix6d isotropic(double deviation_m, double deviation_rad,
                   const Eigen::Vector3d& position_world) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(deviation_m * deviation_m),
      Eigen::Vector3d::Constant(deviation_rad * deviation_rad);
  const Matrix6d back = at_camera(-position_world);
  return back * variances.asDiagonal() * back.transpose();
}

}  // namespace hermite::track
