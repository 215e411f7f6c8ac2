#include "core/track/pose_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/track/twist_covariance.h"

namespace hermite::track {

namespace {

double largest_sigma(const Eigen::Matrix3d& moment) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
}

}  // namespace

double PoseUncertainty::position_sigma_m() const {
  return largest_sigma(second_moment.topLeftCorner<3, 3>());
}
double PoseUncertainty::rotation_sigma_rad() const {
  return largest_sigma(second_moment.bottomRightCorner<3, 3>());
}

Eigen::Vector3d PoseUncertainty::worst_direction() const {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second_moment.topLeftCorner<3, 3>())
      .eigenvectors()
      .col(2);
}

PoseUncertainty with_steps(PoseUncertainty uncertainty, const frame::DepthSteps& steps) {
  uncertainty.steps = steps;
  if (steps.terrace_m <= 0) return uncertainty;
  const double turned_rad = steps.terrace_m / steps.depth_m;
  uncertainty.second_moment.diagonal().head<3>().array() += steps.terrace_m * steps.terrace_m;
  uncertainty.second_moment.diagonal().tail<3>().array() += turned_rad * turned_rad;
  return uncertainty;
}

PoseUncertainty with_error(PoseUncertainty uncertainty, const Vector6d& twist_world,
                           const Eigen::Vector3d& position_world) {
  const Vector6d error = at_camera(position_world) * twist_world;
  uncertainty.second_moment += error * error.transpose();
  return uncertainty;
}

}  // namespace hermite::track
