#include "core/dataset/pose_matrix.h"

#include <Eigen/LU>

namespace hermite::dataset {

namespace {
// Matrices written with three digits pass, scaled ones do not.
constexpr double kRotationTolerance = 0.01;
}  // namespace

std::optional<Rigid3> rigid_pose(const Eigen::Matrix4d& matrix) {
  if (!matrix.allFinite()) return std::nullopt;
  const Eigen::Matrix3d upper = matrix.topLeftCorner<3, 3>();
  const double error =
      (upper * upper.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kRotationTolerance) || upper.determinant() < 0 ||
      matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    return std::nullopt;
  return rigid3_from_matrix(matrix);
}

}  // namespace hermite::dataset
