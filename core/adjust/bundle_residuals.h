// The residuals of bundle adjustment and their derivatives, independent of the solver. A submap's
// pose is perturbed on the right: world_from_submap * exp_se3(twist), with metres first, then
// radians, in the submap's frame. Derivatives are taken at zero twist.
#pragma once

#include "core/adjust/bundle.h"

namespace hermite::adjust {

using Matrix36d = Eigen::Matrix<double, 3, 6>;

// A depth [m] below what any supported depth sensor measures (0.3 m), by a margin. A nearer point
// is projected as if at this depth, so a residual stays finite and continuous behind the camera,
// and its depth component leads the point back.
inline constexpr double kNearest_m = 0.1;

// What all observations of a keyframe share.
struct KeyframeView {
  Eigen::Matrix3d camera_from_submap_rotation;
  Eigen::Vector3d camera_from_submap_translation;
  double fx, fy, cx, cy;  // pixels
};
KeyframeView view_of(const BundleKeyframe& keyframe, const Camera& camera);
std::vector<KeyframeView> views_of(const BundleProblem& problem);  // one per keyframe

// Predicted minus measured, over the standard deviation: u, v, depth. The last is zero for an
// observation without depth.
struct ObservationResidual {
  Eigen::Vector3d whitened;
  double landmark_depth_m = 0;  // in the camera frame, before kNearest_m applies
};
struct ObservationDerivatives {
  Matrix36d by_submap;          // d whitened / d twist of world_from_submap
  Eigen::Matrix3d by_landmark;  // d whitened / d landmark in the world
};
// `derivatives` may be null.
ObservationResidual observation_residual(const BundleObservation& observation,
                                         const KeyframeView& view, const Rigid3& world_from_submap,
                                         const Eigen::Vector3d& landmark_in_world,
                                         ObservationDerivatives* derivatives);

// Returns the chi-square bound of the observation, with or without depth.
double chi2_bound(const BundleObservation& observation);

// The residual is log_se3 of the deviation from the measured relative pose, not whitened. It is
// discontinuous at a rotation of exactly half a turn.
struct LinkDerivatives {
  Matrix6d by_from, by_to;  // d residual / d twist of world_from_from and of world_from_to
};
Vector6d link_residual(const Rigid3& from_from_to, const Rigid3& world_from_from,
                       const Rigid3& world_from_to, LinkDerivatives* derivatives);

// Returns a root W of the information with |W r|^2 = r' information r. Eigenvalues that rounding
// made negative count as zero.
Matrix6d square_root_of(const Matrix6d& information);

}  // namespace hermite::adjust
