// Trajectories as other programs take them. Text, nine decimals, world_from_camera, metres: deterministic, pure.
#pragma once

#include <string>

#include "core/dataset/trajectory.h"

namespace hermite {

// KITTI odometry: three rows of a 4x4 matrix in one line, a line for each pose. The format has neither times nor numbers: of a trajectory
// with a pose for every frame, line i is of frame i.
std::string format_kitti_trajectory(const Trajectory& trajectory);

// Redwood and Open3D (.log): for each pose "i i i+1", then the 4x4 matrix. `frames`: the place of each pose's frame among all, ascending
// and as many as poses (CHECK).
std::string format_log_trajectory(const Trajectory& trajectory, const std::vector<std::int64_t>& frames);

// Where frames of a result were lost, their poses are those of the frame before (the last good one), to the last digit. True: the pose is
// the frame's own. Frames at the beginning that have one pose are all taken for lost if there are several: before the map begins none has
// a pose of its own, and which of them it began with the trajectory does not tell.
std::vector<bool> tracked_frames(const Trajectory& trajectory);

}  // namespace hermite
