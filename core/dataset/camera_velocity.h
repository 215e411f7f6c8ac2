// The velocity of a camera along a trajectory. Pure functions, any thread.
#pragma once

#include <optional>

#include "core/dataset/trajectory.h"
#include "core/math/rigid3.h"

namespace hermite::dataset {

// Poses that are farther apart in time do not tell the velocity at one of them, since a hand
// changes its direction within some tenths of a second: ten frames per second, and a fifth more.
inline constexpr double kMaxVelocityGap_s = 0.12;

// Returns the camera's twist per second (translation part first), in its own coordinate frame at
// that time, so that its pose a time t later is world_from_camera * exp_se3(t * twist). It is taken
// between the poses before and after that of `timestamp_s`; at the ends of the trajectory and
// beside gaps, from one of them. std::nullopt if neither is at most kMaxVelocityGap_s away, or if
// there is no pose at that time.
std::optional<Vector6d> twist_per_s_at(const Trajectory& trajectory, double timestamp_s);

}  // namespace hermite::dataset
