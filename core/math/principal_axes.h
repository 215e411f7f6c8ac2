// The directions in which points spread. Pure function, any thread.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

namespace hermite {

// The longest axis first: the last one is the normal of the plane that fits the points best.
struct PrincipalAxes {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 3> direction;  // orthonormal, each of either sign
  std::array<double, 3> deviation{};         // standard deviation of the points along it, in their unit
};

// Returns the axes of at least one point. `weights` are of the same number as the points and not negative, with a positive sum; all points
// weigh the same when there are none.
PrincipalAxes principal_axes(std::span<const Eigen::Vector3d> points, std::span<const double> weights = {});

// Returns `axis` or its opposite, whichever has the direction of `towards`.
inline Eigen::Vector3d facing(const Eigen::Vector3d& axis, const Eigen::Vector3d& towards) {
  return axis.dot(towards) < 0 ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace hermite
