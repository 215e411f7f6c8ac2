// Poses that data sets store as 4x4 matrices. Pure.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/math/rigid3.h"

namespace hermite::dataset {

// Returns std::nullopt when a number is not finite, the upper left block is not a rotation within 1
// % or is a reflection, or the last row is not 0 0 0 1.
std::optional<Rigid3> rigid_pose(const Eigen::Matrix4d& matrix);

}  // namespace hermite::dataset
