// Covariances of twists about the world's origin, and of the errors of a camera's pose: its
// position along the world's axes [m], then its rotation as a vector along the world's axes [rad].
// Pure functions.
#pragma once

#include <Eigen/Core>

#include "core/math/rigid3.h"

namespace hermite::track {

// Returns the matrix that converts a twist about the world's origin to the errors of a camera at
// that position; that of the negated position converts back.
Matrix6d at_camera(const Eigen::Vector3d& position_world);

// Returns isotropic covariances of a camera's position and rotation as the covariance of a twist
// about the world's origin.
Matrix6d isotropic(double deviation_m, double deviation_rad, const Eigen::Vector3d& position_world);

}  // namespace hermite::track
