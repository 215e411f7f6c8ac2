#include "core/mesh/edge_vertex.h"

#include <Eigen/Eigenvalues>

#include "core/base/check.h"

namespace hermite::mesh {
namespace {

// As a fraction of the largest eigenvalue: two planes make a sharp edge when they differ by 16
// degrees or more, since the smaller of their eigenvalues is the larger times tan^2 of half their
// angle. Normals of a real scan differ by a few degrees within a wall.
constexpr double kLeastShare = 0.02;

}  // namespace

EdgeVertex meet(std::span<const SurfacePlane> planes) {
  CHECK(!planes.empty(), "no planes meet nowhere");
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const SurfacePlane& plane : planes) mean += plane.point_m.cast<double>();
  mean /= static_cast<double>(planes.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const SurfacePlane& plane : planes) {
    const Eigen::Vector3d normal = plane.normal.cast<double>();
    sum += normal * normal.transpose();
    right += normal * normal.dot(plane.point_m.cast<double>() - mean);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum);
  EdgeVertex vertex;
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const double value = solver.eigenvalues()[i];
    if (!(value > kLeastShare * solver.eigenvalues()[2])) continue;
    const Eigen::Vector3d direction = solver.eigenvectors().col(i);
    step += direction * (direction.dot(right) / value);
    ++vertex.rank;
  }
  vertex.position_m = (mean + step).cast<float>();
  return vertex;
}

}  // namespace hermite::mesh
