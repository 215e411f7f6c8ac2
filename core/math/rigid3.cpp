#include "core/math/rigid3.h"

#include <cmath>

namespace hermite {

namespace {

// V(w) of the SE(3) exponential: I + (1-cos)/angle^2 [w] + (angle-sin)/angle^3 [w]^2, by series
// near zero.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& rotation_vector) {
  const double angle2 = rotation_vector.squaredNorm();
  const double angle = std::sqrt(angle2);
  const bool small = angle < 1e-5;
  const double a = small ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
  const double b =
      small ? 1.0 / 6.0 - angle2 / 120.0 : (angle - std::sin(angle)) / (angle2 * angle);
  const Eigen::Matrix3d w = skew(rotation_vector);
  return Eigen::Matrix3d::Identity() + a * w + b * w * w;
}

Eigen::Vector3d rotation_vector_of(const Eigen::Quaterniond& rotation) {
  const Eigen::Quaterniond q = rotation.w() < 0 ? Eigen::Quaterniond(-rotation.coeffs()) : rotation;
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * q.vec();
  return q.vec() * (2.0 * std::atan2(sine, q.w()) / sine);
}

}  // namespace

Matrix6d adjoint(const Rigid3& target_from_source) {
  const Eigen::Matrix3d rotation = target_from_source.rotation.toRotationMatrix();
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = rotation;
  adjoint.bottomRightCorner<3, 3>() = rotation;
  adjoint.topRightCorner<3, 3>() = skew(target_from_source.translation) * rotation;
  return adjoint;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix4d Rigid3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = translation;
  return m;
}

Rigid3 operator*(const Rigid3& a_from_b, const Rigid3& b_from_c) {
  return {(a_from_b.rotation * b_from_c.rotation).normalized(), a_from_b * b_from_c.translation};
}

Rigid3 inverse(const Rigid3& a_from_b) {
  const Eigen::Quaterniond rotation = a_from_b.rotation.conjugate();
  return {rotation, -(rotation * a_from_b.translation)};
}

Rigid3 rigid3_from_matrix(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d upper = matrix.topLeftCorner<3, 3>();
  return {Eigen::Quaterniond(upper).normalized(), matrix.topRightCorner<3, 1>()};
}

Rigid3 exp_se3(const Vector6d& twist) {
  const Eigen::Vector3d rotation_vector = twist.tail<3>();
  const double angle = rotation_vector.norm();
  const double half_sine_over_angle = angle < 1e-8 ? 0.5 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond rotation;
  rotation.w() = std::cos(0.5 * angle);
  rotation.vec() = half_sine_over_angle * rotation_vector;
  return {rotation.normalized(), left_jacobian(rotation_vector) * twist.head<3>()};
}

Vector6d log_se3(const Rigid3& transform) {
  const Eigen::Vector3d rotation_vector = rotation_vector_of(transform.rotation);
  Vector6d twist;
  twist.head<3>() = left_jacobian(rotation_vector).partialPivLu().solve(transform.translation);
  twist.tail<3>() = rotation_vector;
  return twist;
}

Rigid3 between(const Rigid3& from, const Rigid3& to, double share) {
  return {from.rotation.slerp(share, to.rotation),
          from.translation + share * (to.translation - from.translation)};
}

double angle_rad(const Eigen::Quaterniond& rotation) { return rotation_vector_of(rotation).norm(); }

bool is_finite(const Rigid3& transform) {
  return transform.rotation.coeffs().allFinite() && transform.translation.allFinite();
}

}  // namespace hermite
