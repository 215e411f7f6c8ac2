// Iterative closest points, point to plane, of two scans: from a rough pose to one as accurate as
// the surfaces allow. Tolerates things that were moved, added or removed. Pure functions.
#pragma once

#include "core/compare/agreement.h"
#include "core/math/rigid3.h"

namespace hermite::compare {

// Aligns samples, from correspondences up to five spacings of samples apart to such of one. The
// result is accurate to a tenth of a spacing if `a_from_b` was within some spacings and 15 degrees.
// Uses at most about `most` samples of B.
Rigid3 aligned_roughly(const CoarseScan& a, const CoarseScan& b, const Rigid3& a_from_b,
                       std::size_t most);

// The result of the exact alignment. Twists are applied in A's world: a_from_b = exp_se3(twist) *
// estimate.
struct ScanAlignment {
  Rigid3 a_from_b;
  // Covariance of the twist. The residuals of one region share the drift of both scans there; so
  // the covariance is estimated from the sums of regions of half a metre (cluster-robust
  // covariance: Liang, Zeger, "Longitudinal data analysis using generalized linear models",
  // Biometrika 1986), not from single residuals.
  Matrix6d covariance = Matrix6d::Zero();
  // By how much regions of the two scans still disagree along their normals, as a standard
  // deviation: the drift of both, which no rigid transform removes.
  double disagreement_m = 0;
  // Standard deviation of the least certain motion of the middle of the common surface, and its
  // direction.
  double weakest_sigma_m = 0;
  Eigen::Vector3d weakest_direction = Eigen::Vector3d::Zero();
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();  // of the common surface, in A's world
  // Places of B that have been aligned; below kLeastPlaces all else is invalid.
  std::size_t place_count = 0;
};
inline constexpr std::size_t kLeastPlaces = 30;

// Aligns planes fitted to the surfels of both scans, weighted by their standard deviations. Expects
// a result of aligned_roughly.
ScanAlignment aligned_exactly(const CoarseScan& a, const CoarseScan& b, const Rigid3& a_from_b);

}  // namespace hermite::compare
