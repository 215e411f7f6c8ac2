// The directions in which points spread. Pure function. Any thread.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

namespace hermite {

// The longest axis comes first; the last one is the normal of the best-fitting plane.
struct PrincipalAxes {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 3> direction;  // orthonormal, each of either sign
  // Standard deviation of the points along it, in their unit.
  std::array<double, 3> deviation{};
};

// Returns the axes of at least one point. `weights` are as many as the points, not negative, with a
// positive sum; if there are none, all points have the same weight.
PrincipalAxes principal_axes(std::span<const Eigen::Vector3d> points,
                             std::span<const double> weights = {});

// Returns `axis` or its opposite, whichever has the direction of `towards`.
inline Eigen::Vector3d facing(const Eigen::Vector3d& axis, const Eigen::Vector3d& towards) {
  return axis.dot(towards) < 0 ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace hermite
