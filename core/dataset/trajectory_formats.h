// Trajectories in formats of other programs. Text, nine decimals, world_from_camera, metres.
// Deterministic, pure.
#pragma once

#include <string>

#include "core/dataset/trajectory.h"

namespace hermite::dataset {

// KITTI odometry: a line for each pose, with three rows of a 4x4 matrix. The format has neither
// times nor numbers: if the trajectory has a pose for every frame, line i is frame i.
std::string format_kitti_trajectory(const Trajectory& trajectory);

// Redwood and Open3D (.log): for each pose "i i i+1", then the 4x4 matrix. `frames` are the frame
// indices of the poses, ascending. CHECK: there are as many as poses.
std::string format_log_trajectory(const Trajectory& trajectory,
                                  const std::vector<std::int64_t>& frames);

// Returns, by pose, whether it is the frame's own. Lost frames of a result have exactly the pose of
// the frame before (the last good one). If several frames at the start have the same pose, all of
// them are taken to be lost: before the map starts no frame has a pose of its own, and the
// trajectory does not show with which of them it started.
std::vector<bool> tracked_frames(const Trajectory& trajectory);

}  // namespace hermite::dataset
