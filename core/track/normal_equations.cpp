#include "core/track/normal_equations.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace hermite {

NormalEquations discount_normal_noise(const NormalEquations& geometric, const Matrix6d& displacement, double disagreement) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> motions(geometric.hessian, displacement);
  if (motions.info() != Eigen::Success || !motions.eigenvectors().allFinite()) return {};
  const Vector6d kept = (motions.eigenvalues().array() - disagreement / 4).cwiseMax(0.0);
  const Vector6d gain = (kept.array() > 0).select(kept.array() / motions.eigenvalues().array(), 0.0);
  const Matrix6d dual = displacement * motions.eigenvectors();
  return {dual * kept.asDiagonal() * dual.transpose(),
          dual * (gain.asDiagonal() * (motions.eigenvectors().transpose() * geometric.right_hand_side))};
}

Vector6d solve(const NormalEquations& geometric, const NormalEquations& photometric, const Matrix6d& displacement) {
  // A millionth of what the points would move by: nothing beside any knowledge, all where there is none.
  const Matrix6d hessian = geometric.hessian + photometric.hessian + 1e-6 * displacement;
  return hessian.ldlt().solve(geometric.right_hand_side + photometric.right_hand_side);
}

double observability(const Matrix6d& hessian, const Matrix6d& displacement) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> motions(hessian, displacement, Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  if (motions.info() != Eigen::Success || !motions.eigenvalues().allFinite()) return 0;
  return std::max(0.0, motions.eigenvalues()[0]);
}

}  // namespace hermite
