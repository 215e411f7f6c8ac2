#include "core/track/step_certainty.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace hermite::track {

namespace {

// Number of residuals with a common error, by kind of residual; so many count as one.
constexpr double kAlikeDepth = 6, kAlikeImage = 6, kAlikeCorners = 1;

struct Alone {
  const char* name;
  Matrix6d information;
  Vector6d pull;  // information * step
};

}  // namespace

Matrix6d step_covariance(const StepWitnesses& w) {
  const double unit = std::max({w.depth.unit, w.image.unit, 1e-300});
  const Matrix6d prior = motion_prior(1, Vector6d::Zero()).hessian;
  const Matrix6d said =
      beyond_noise(w.depth.system.hessian + w.image.system.hessian, w.displacement);
  const Matrix6d depth = said.transpose() * w.depth.system.hessian * said,
                 image = w.image_weight * (said.transpose() * w.image.system.hessian * said);
  const Matrix6d hessian =
      depth + image + w.corner_weight * w.corners.system.hessian + unit * prior;
  const Matrix6d scores =
      kAlikeDepth * w.depth.unit * depth + kAlikeImage * w.image_weight * w.image.unit * image +
      kAlikeCorners * w.corner_weight * w.corner_weight * w.corners.system.hessian +
      unit * unit * prior;
  const Eigen::LDLT<Matrix6d> solver(hessian);
  const Matrix6d half = solver.solve(scores);
  const Matrix6d covariance = solver.solve(half.transpose());
  return 0.5 * (covariance + covariance.transpose());
}

Contradiction contradiction(const StepWitnesses& w) {
  const auto alone = [](const char* name, const StepWitness& witness, double alike) {
    const double scale = witness.unit > 0 ? 1 / (alike * witness.unit) : 0;
    return Alone{name, scale * witness.system.hessian, scale * witness.system.right_hand_side};
  };
  const std::array<Alone, 3> all{alone("depth", w.depth, kAlikeDepth),
                                 alone("picture", w.image, kAlikeImage),
                                 alone("corners", w.corners, kAlikeCorners)};
  const Matrix6d prior = motion_prior(1, Vector6d::Zero()).hessian;
  Contradiction worst;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (!(all[i].information.trace() > 0) || !(all[j].information.trace() > 0)) continue;
      const Matrix6d first = (all[i].information + prior).ldlt().solve(Matrix6d::Identity());
      const Matrix6d second = (all[j].information + prior).ldlt().solve(Matrix6d::Identity());
      const Vector6d apart = first * all[i].pull - second * all[j].pull;
      const double sigmas =
          std::sqrt(std::max(0.0, apart.dot((first + second).ldlt().solve(apart))));
      if (sigmas <= worst.sigmas) continue;
      worst = {sigmas, apart.head<3>().norm(), apart.tail<3>().norm(), all[i].name, all[j].name};
    }
  return worst;
}

}  // namespace hermite::track
