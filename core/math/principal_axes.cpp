#include "core/math/principal_axes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace hermite {

PrincipalAxes principal_axes(std::span<const Eigen::Vector3d> points,
                             std::span<const double> weights) {
  const double sum = weights.empty() ? static_cast<double>(points.size())
                                     : std::accumulate(weights.begin(), weights.end(), 0.0);
  const auto share = [&](std::size_t i) { return (weights.empty() ? 1.0 : weights[i]) / sum; };
  PrincipalAxes found;
  for (std::size_t i = 0; i < points.size(); ++i) found.centre += share(i) * points[i];
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
    spread += share(i) * (points[i] - found.centre) * (points[i] - found.centre).transpose();
  // Eigenvalues are in increasing order.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  for (int i = 0; i < 3; ++i) {
    found.direction[static_cast<std::size_t>(i)] = solver.eigenvectors().col(2 - i);
    found.deviation[static_cast<std::size_t>(i)] =
        std::sqrt(std::max(0.0, solver.eigenvalues()[2 - i]));
  }
  return found;
}

}  // namespace hermite
