// How well a pose of the camera is known. Plain values, any thread.
#pragma once

#include <Eigen/Core>

#include "core/frame/depth_steps.h"
#include "core/math/rigid3.h"

namespace hermite::track {

// The 99 % quantile of the squared Mahalanobis distance in six dimensions: the region that is
// stated for a pose.
inline constexpr double kRegion99 = 16.812;

// Uncertainty of world_from_camera, in the world given by the first frame of the component: errors
// of the position along the world's axes [m], then of the rotation as a vector along the world's
// axes [rad] (estimated = exp(error) true). It is the second moment, which includes the known
// systematic errors and the doubt about the place.
struct PoseUncertainty {
  Matrix6d second_moment = Matrix6d::Zero();
  double way_m = 0;  // path length of the camera since that first frame
  // How far away the camera may be at a place that looks the same (place_doubt.h); 0 if there is no
  // doubt.
  double elsewhere_m = 0;

  frame::DepthSteps steps = {};  // of the sensor, whose errors are included

  // Return the standard deviation along the axis of largest error.
  double position_sigma_m() const;
  double rotation_sigma_rad() const;
  // Returns the unit vector, in the world, along which the position is least certain.
  Eigen::Vector3d worst_direction() const;
};

// Returns the uncertainty with the errors by the steps of depth, which are alike in neighbouring
// frames.
PoseUncertainty with_steps(PoseUncertainty uncertainty, const frame::DepthSteps& steps);

// Returns the uncertainty with an error that may have been made, as a twist about the world's
// origin, of a camera at this position.
PoseUncertainty with_error(PoseUncertainty uncertainty, const Vector6d& twist_world,
                           const Eigen::Vector3d& position_world);

}  // namespace hermite::track
