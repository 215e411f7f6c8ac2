// A rigid transform, named target_from_source: p_target = rotation * p_source + translation.
// Metres. Composed as the names read from left to right: a_from_c = a_from_b * b_from_c. Plain
// value.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hermite {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // metres

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }
  Eigen::Matrix4d matrix() const;
};

// The result's quaternion is normalised.
Rigid3 operator*(const Rigid3& a_from_b, const Rigid3& b_from_c);
Rigid3 inverse(const Rigid3& a_from_b);

// Uses the nearest rotation to the upper left block (Gram-Schmidt through a quaternion).
Rigid3 rigid3_from_matrix(const Eigen::Matrix4d& matrix);

// Exponential map of the twist (translation part [m] first, rotation vector [rad] last), and its
// inverse.
Rigid3 exp_se3(const Vector6d& twist);
Vector6d log_se3(const Rigid3& transform);

// target_from_source * exp_se3(twist) = exp_se3(adjoint(target_from_source) * twist) *
// target_from_source.
Matrix6d adjoint(const Rigid3& target_from_source);

// skew(a) * b is the cross product of a and b.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

double angle_rad(const Eigen::Quaterniond& rotation);

// Returns the pose that is `share` (0 to 1) of the way from one to the other, at constant velocity
// of position and rotation.
Rigid3 between(const Rigid3& from, const Rigid3& to, double share);

bool is_finite(const Rigid3& transform);

}  // namespace hermite
