// The velocity of a camera along a trajectory. Pure functions, any thread.
#pragma once

#include <optional>

#include "core/dataset/trajectory.h"
#include "core/math/rigid3.h"

namespace hermite {

// Returns the camera's twist per second (translation part first), in its own coordinate frame at that time, so that its
// pose a time t later is world_from_camera * exp_se3(t * twist). It is taken between the poses before and after that of
// `timestamp_s`; at the ends of the trajectory and beside gaps, from one of them. std::nullopt if neither is at most
// kMaxPoseGap_s away, or if there is no pose at that time.
inline constexpr double kMaxPoseGap_s = 0.1;
inline constexpr double kSameTime_s = 1e-4;  // timestamps in a trajectory file are rounded to microseconds
std::optional<Vector6d> twist_per_s_at(const Trajectory& trajectory, double timestamp_s);

}  // namespace hermite
