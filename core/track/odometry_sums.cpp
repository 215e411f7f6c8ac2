#include "core/track/odometry_sums.h"

#include "core/math/rigid3.h"

namespace hermite::track {

namespace {

// Degrees of freedom of Student's t distribution, as in shaders/track/odometry.comp (Kerl, Sturm,
// Cremers 2013 found that 5 fits).
constexpr double kDegreesOfFreedom = 5;

template <class Matrix>
Matrix read_upper_triangle(const double* next) {
  Matrix matrix;
  for (int i = 0; i < matrix.rows(); ++i)
    for (int j = i; j < matrix.cols(); ++j) matrix(i, j) = matrix(j, i) = *next++;
  return matrix;
}

NormalEquations read_system(const double* sums) {
  constexpr int kUpperTriangle = 21;
  return {read_upper_triangle<Matrix6d>(sums), Eigen::Map<const Vector6d>(sums + kUpperTriangle)};
}

// Returns the weighted sum over points s of A^T A with A = [1, -[s]x], which maps a twist to their
// displacement. `moments` are the sums of 1, s and the upper triangle of s s^T.
Matrix6d read_displacement(const double* moments) {
  const Eigen::Vector3d first(moments[1], moments[2], moments[3]);
  const auto second = read_upper_triangle<Eigen::Matrix3d>(moments + 4);
  Matrix6d displacement = Matrix6d::Zero();
  displacement.topLeftCorner<3, 3>() = moments[0] * Eigen::Matrix3d::Identity();
  displacement.bottomLeftCorner<3, 3>() = skew(first);
  displacement.topRightCorner<3, 3>() = displacement.bottomLeftCorner<3, 3>().transpose();
  displacement.bottomRightCorner<3, 3>() = second.trace() * Eigen::Matrix3d::Identity() - second;
  return displacement;
}

}  // namespace

OdometrySums::OdometrySums(const OdometryTerms& terms, double all_pixels)
    : pixel_count(all_pixels) {
  const auto from_term = [&terms](shared::uint first) { return terms.data() + first; };
  geometric = read_system(from_term(shared::kGeometricSums));
  photometric.motion = read_system(from_term(shared::kPhotometricSums));
  displacement = read_displacement(from_term(shared::kMomentSums));
  const double weight = terms[shared::kMomentSums], near_weight = terms[shared::kNearSums + 1];
  disagreement = weight > 0 ? terms[shared::kDisagreementSum] / weight : 0;
  near_disagreement = near_weight > 0 ? terms[shared::kNearSums] / near_weight : 0;
  geometric_error_m2 = terms[shared::kGeometricErrorSums];
  geometric_count = terms[shared::kGeometricErrorSums + 1];
  photometric_count = terms[shared::kPhotometricErrorSums + 1];
  surface_count = terms[shared::kSurfaceCountSum];
  photometric.mixed =
      Eigen::Map<const Eigen::Matrix<double, 6, 2, Eigen::RowMajor>>(from_term(shared::kMixedSums));
  photometric.hessian = read_upper_triangle<Eigen::Matrix2d>(from_term(shared::kBrightnessSums));
  photometric.right_hand_side =
      Eigen::Map<const Eigen::Vector2d>(from_term(shared::kBrightnessSums + 3));
  constexpr double kOfStudentsT = (kDegreesOfFreedom + 1) / kDegreesOfFreedom;
  const double geometric_squares = terms[shared::kGeometricSpreadSums + 1],
               photometric_base = terms[shared::kPhotometricSpreadSums];
  photometric_squares = terms[shared::kPhotometricSpreadSums + 1];
  geometric_base = terms[shared::kGeometricSpreadSums];
  if (terms[shared::kGradientSums + 1] > 0)
    gradient_share = terms[shared::kGradientSums] / terms[shared::kGradientSums + 1];
  if (geometric_base > 0) geometric_spread2 = kOfStudentsT * geometric_squares / geometric_base;
  if (photometric_base > 0)
    photometric_spread2 = kOfStudentsT * photometric_squares / photometric_base;
}

}  // namespace hermite::track
