#include "core/track/normal_equations.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace hermite::track {

namespace {

// The prior of an unchanged brightness acts like further residuals, in grey values, with these
// shares of the image's weight. A change of the gain by 0.5 counts as 20 grey values; its share is
// so small that the prior decides only where there is no contrast. The offset is hardly free:
// exposure scales grey values, and a free offset would explain the map's blur as a gain above 1,
// fuse with it, and so fade the map from frame to frame (to 1.4 within four frames of sparse
// depth).
constexpr double kGainShare = 1e-3, kOffsetShare = 1, kOffsetOverGain = 20 / 0.5;

// The largest motion of a camera between two frames.
constexpr double kMost_m = 0.3, kMost_rad = 0.5;

struct BrightnessSystem {
  Eigen::Matrix2d hessian;
  Eigen::Vector2d right_hand_side;
};

BrightnessSystem with_prior(const PhotometricSystem& system, const frame::Brightness& at) {
  const Eigen::Vector2d prior =
      system.hessian(1, 1) *
      Eigen::Vector2d(kGainShare * kOffsetOverGain * kOffsetOverGain, kOffsetShare);
  return {system.hessian + Eigen::Matrix2d(prior.asDiagonal()),
          system.right_hand_side + prior.cwiseProduct(Eigen::Vector2d(1 - at.gain, -at.offset))};
}

}  // namespace

NormalEquations without_brightness(const PhotometricSystem& system, const frame::Brightness& at) {
  if (system.hessian(1, 1) <= 0) return {};
  const BrightnessSystem known = with_prior(system, at);
  const Eigen::Matrix<double, 6, 2> eliminated =
      known.hessian.ldlt().solve(system.mixed.transpose()).transpose();
  return {system.motion.hessian - eliminated * system.mixed.transpose(),
          system.motion.right_hand_side - eliminated * known.right_hand_side};
}

frame::Brightness brightness_after(const PhotometricSystem& system, const frame::Brightness& at,
                                   const Vector6d& step) {
  if (system.hessian(1, 1) <= 0) return at;
  const BrightnessSystem known = with_prior(system, at);
  const Eigen::Vector2d change =
      known.hessian.ldlt().solve(known.right_hand_side - system.mixed.transpose() * step);
  return {at.gain + change[0], at.offset + change[1]};
}

NormalEquations discount_normal_noise(const NormalEquations& geometric,
                                      const Matrix6d& displacement, double disagreement) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> motions(geometric.hessian, displacement);
  if (motions.info() != Eigen::Success || !motions.eigenvectors().allFinite()) return {};
  const Vector6d kept = (motions.eigenvalues().array() - disagreement / 4).cwiseMax(0.0);
  const Vector6d gain =
      (kept.array() > 0).select(kept.array() / motions.eigenvalues().array(), 0.0);
  const Matrix6d dual = displacement * motions.eigenvectors();
  return {dual * kept.asDiagonal() * dual.transpose(),
          dual * (gain.asDiagonal() *
                  (motions.eigenvectors().transpose() * geometric.right_hand_side))};
}

Vector6d solve(const NormalEquations& geometric, const NormalEquations& photometric,
               const Matrix6d& displacement) {
  // A millionth of the points' displacement: negligible beside any information, decisive where
  // there is none.
  const Matrix6d hessian = geometric.hessian + photometric.hessian + 1e-6 * displacement;
  return hessian.ldlt().solve(geometric.right_hand_side + photometric.right_hand_side);
}

NormalEquations motion_prior(double unit, const Vector6d& beyond_expected) {
  Vector6d information;
  information << Eigen::Vector3d::Constant(unit / (kMost_m * kMost_m)),
      Eigen::Vector3d::Constant(unit / (kMost_rad * kMost_rad));
  return {information.asDiagonal(), -information.cwiseProduct(beyond_expected)};
}

double observability(const Matrix6d& hessian, const Matrix6d& displacement) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> motions(
      hessian, displacement, Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  if (motions.info() != Eigen::Success || !motions.eigenvalues().allFinite()) return 0;
  return std::max(0.0, motions.eigenvalues()[0]);
}

Matrix6d beyond_noise(const Matrix6d& hessian, const Matrix6d& displacement) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> motions(hessian, displacement);
  if (motions.info() != Eigen::Success || !motions.eigenvectors().allFinite())
    return Matrix6d::Identity();
  const Vector6d kept = (motions.eigenvalues().array() - kNoiseObservability).cwiseMax(0.0);
  const Vector6d share =
      (kept.array() > 0).select(kept.array() / motions.eigenvalues().array(), 0.0).sqrt();
  return motions.eigenvectors() * share.asDiagonal() * motions.eigenvectors().transpose() *
         displacement;
}

}  // namespace hermite::track
