// The residuals of bundle adjustment and their derivatives, free of any solver. A submap's pose is varied on the right:
// world_from_submap * exp_se3(twist), so a twist is metres first, then radians, in the submap's frame; derivatives are at zero twist.
#pragma once

#include "core/adjust/bundle.h"

namespace hermite {

using Matrix36d = Eigen::Matrix<double, 3, 6>;

// Nearer than any depth sensor of ours measures (notes section 1.2: 0.3 m) by a margin. The projection of a nearer point is that at this
// depth, so a residual stays finite and continuous behind the camera, and the depth's part of it leads the point back.
inline constexpr double kNearest_m = 0.1;

// What a keyframe's observations share.
struct KeyframeView {
  Eigen::Matrix3d camera_from_submap_rotation;
  Eigen::Vector3d camera_from_submap_translation;
  double fx, fy, cx, cy;  // pixels
};
KeyframeView view_of(const BundleKeyframe& keyframe, const Camera& camera);
std::vector<KeyframeView> views_of(const BundleProblem& problem);  // one a keyframe

// Predicted less measured, over the standard deviation: u, v, depth. The last is zero for an observation without depth.
struct ObservationResidual {
  Eigen::Vector3d whitened;
  double landmark_depth_m = 0;  // of the landmark in the camera, before kNearest_m applies
};
struct ObservationDerivatives {
  Matrix36d by_submap;          // of `whitened`, by the twist of world_from_submap
  Eigen::Matrix3d by_landmark;  // by the landmark in the world
};
// `derivatives` may be null.
ObservationResidual observation_residual(const BundleObservation& observation, const KeyframeView& view, const Rigid3& world_from_submap,
                                         const Eigen::Vector3d& landmark_in_world, ObservationDerivatives* derivatives);

// The chi-square bound of that observation, with or without depth.
double chi2_bound(const BundleObservation& observation);

// log_se3 of the deviation from the measured relative pose, not whitened. At a deviation of exactly half a turn it jumps.
struct LinkDerivatives {
  Matrix6d by_from, by_to;  // by the twists of world_from_from and world_from_to
};
Vector6d link_residual(const Rigid3& from_from_to, const Rigid3& world_from_from, const Rigid3& world_from_to,
                       LinkDerivatives* derivatives);

// A root W of the information, so that |W r|^2 = r' information r. Eigenvalues below zero by rounding count as zero.
Matrix6d square_root_of(const Matrix6d& information);

}  // namespace hermite
