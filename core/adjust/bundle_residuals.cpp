#include "core/adjust/bundle_residuals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/adjust/bundle_noise.h"

namespace hermite::adjust {

namespace {

// Coefficients of the left Jacobians below, as functions of the angle. Below `kSeries_rad` they are
// series to the fourth power, whose next term is a factor of less than 1e-10; above it, the closed
// forms lose less than that to cancellation.
struct AngleCoefficients {
  double inverse;  // (1 - (a/2) cot(a/2)) / a^2
  // (a - sin a) / a^3, (a^2 + 2 cos a - 2) / (2 a^4), (2 a - 3 sin a + a cos a) / (2 a^5).
  double q1, q2, q3;
};
AngleCoefficients coefficients_at(double angle) {
  constexpr double kSeries_rad = 0.1;
  const double a = angle, a2 = a * a, a4 = a2 * a2;
  if (a < kSeries_rad)
    return {1.0 / 12 + a2 / 720 + a4 / 30240, 1.0 / 6 - a2 / 120 + a4 / 5040,
            1.0 / 24 - a2 / 720 + a4 / 40320, 1.0 / 120 - a2 / 2520 + a4 / 120960};
  const double sine = std::sin(a), cosine = std::cos(a);
  return {(1 - 0.5 * a / std::tan(0.5 * a)) / a2, (a - sine) / (a2 * a),
          (a2 + 2 * cosine - 2) / (2 * a4), (2 * a - 3 * sine + a * cosine) / (2 * a4 * a)};
}

// Returns the inverse of the left Jacobian of SE(3): log(exp(d) exp(twist)) = twist + J^-1 d to
// first order (Barfoot, State Estimation for Robotics, 2017, equations 7.40, 7.85 and 7.86).
Matrix6d inverse_left_jacobian(const Vector6d& twist) {
  const Eigen::Matrix3d w = skew(twist.tail<3>()), v = skew(twist.head<3>());
  const AngleCoefficients c = coefficients_at(twist.tail<3>().norm());
  const Eigen::Matrix3d wv = w * v, vw = v * w, wvw = wv * w;
  const Eigen::Matrix3d q = 0.5 * v + c.q1 * (wv + vw + wvw) + c.q2 * (w * wv + vw * w - 3 * wvw) +
                            c.q3 * (wvw * w + w * wvw);
  const Eigen::Matrix3d inverse = Eigen::Matrix3d::Identity() - 0.5 * w + c.inverse * w * w;
  Matrix6d jacobian = Matrix6d::Zero();
  jacobian.topLeftCorner<3, 3>() = inverse;
  jacobian.bottomRightCorner<3, 3>() = inverse;
  jacobian.topRightCorner<3, 3>() = -inverse * q * inverse;
  return jacobian;
}

}  // namespace

KeyframeView view_of(const BundleKeyframe& keyframe, const Camera& camera) {
  const Rigid3 camera_from_submap = inverse(keyframe.submap_from_camera);
  return {camera_from_submap.rotation.toRotationMatrix(),
          camera_from_submap.translation,
          camera.fx,
          camera.fy,
          camera.cx,
          camera.cy};
}

std::vector<KeyframeView> views_of(const BundleProblem& problem) {
  std::vector<KeyframeView> views;
  views.reserve(problem.keyframes.size());
  for (const BundleKeyframe& keyframe : problem.keyframes)
    views.push_back(view_of(keyframe, problem.camera));
  return views;
}

ObservationResidual observation_residual(const BundleObservation& observation,
                                         const KeyframeView& view, const Rigid3& world_from_submap,
                                         const Eigen::Vector3d& landmark_in_world,
                                         ObservationDerivatives* derivatives) {
  const Eigen::Matrix3d submap_from_world =
      world_from_submap.rotation.toRotationMatrix().transpose();
  const Eigen::Vector3d in_submap =
      submap_from_world * (landmark_in_world - world_from_submap.translation);
  const Eigen::Vector3d in_camera =
      view.camera_from_submap_rotation * in_submap + view.camera_from_submap_translation;
  const double z = std::max(in_camera.z(), kNearest_m), per_pixel = 1 / observation.scale;
  const double per_metre = observation.depth_m > 0 ? 1 / depth_deviation_m(observation.depth_m) : 0;
  const double u_per_m = view.fx / z * per_pixel, v_per_m = view.fy / z * per_pixel;

  ObservationResidual residual;
  residual.landmark_depth_m = in_camera.z();
  residual.whitened << u_per_m * in_camera.x() + (view.cx - observation.pixel_px.x()) * per_pixel,
      v_per_m * in_camera.y() + (view.cy - observation.pixel_px.y()) * per_pixel,
      (in_camera.z() - observation.depth_m) * per_metre;
  if (derivatives == nullptr) return residual;

  const double z_varies = in_camera.z() > kNearest_m ? 1 : 0;
  Eigen::Matrix3d by_camera_point;
  by_camera_point << u_per_m, 0, -u_per_m * in_camera.x() / z * z_varies, 0, v_per_m,
      -v_per_m * in_camera.y() / z * z_varies, 0, 0, per_metre;
  const Eigen::Matrix3d by_submap_point = by_camera_point * view.camera_from_submap_rotation;
  // exp(-twist) p = p - translation - rotation x p, to first order.
  derivatives->by_submap.leftCols<3>() = -by_submap_point;
  derivatives->by_submap.rightCols<3>().noalias() = by_submap_point * skew(in_submap);
  derivatives->by_landmark.noalias() = by_submap_point * submap_from_world;
  return residual;
}

double chi2_bound(const BundleObservation& observation) {
  return observation.depth_m > 0 ? kPixelAndDepthChi2 : kPixelChi2;
}

Vector6d link_residual(const Rigid3& from_from_to, const Rigid3& world_from_from,
                       const Rigid3& world_from_to, LinkDerivatives* derivatives) {
  const Rigid3 estimated = inverse(world_from_from) * world_from_to;
  const Vector6d residual = log_se3(inverse(from_from_to) * estimated);
  if (derivatives != nullptr) {
    // log(E exp(d)) = log(E) + (right Jacobian)^-1 d, and the right Jacobian at a twist is the left
    // one at its negative. A twist of `from` enters as exp(-d) in front of `estimated`, which
    // equals exp(-adjoint(estimated^-1) d) behind it.
    derivatives->by_to = inverse_left_jacobian(-residual);
    derivatives->by_from.noalias() = -derivatives->by_to * adjoint(inverse(estimated));
  }
  return residual;
}

Matrix6d square_root_of(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information);
  return solver.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

}  // namespace hermite::adjust
