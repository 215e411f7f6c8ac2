// Poses that data sets write as 4x4 matrices. Pure.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/math/rigid3.h"

namespace hermite {

// Nothing when a number is not finite, the rotation is none within 1 % or mirrors, or the last row is not 0 0 0 1.
std::optional<Rigid3> rigid_pose(const Eigen::Matrix4d& matrix);

}  // namespace hermite
