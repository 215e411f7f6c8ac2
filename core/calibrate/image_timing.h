// When the pixels of a frame are taken, relative to its time stamp. Plain values, pure functions, any thread.
//
// A rolling shutter takes each row at its own time, and the colour and depth cameras of a device are not always
// synchronous. Over one frame the camera is taken to move at a constant velocity: at 30 frames per second and a hand's
// acceleration of 1 m/s^2 it deviates from that by 0.1 mm.
#pragma once

#include <optional>

#include "core/dataset/trajectory.h"
#include "core/math/rigid3.h"

namespace hermite {

struct ImageTiming {
  double depth_readout_s = 0;  // from the first row of depth to the last one; the middle row has the time stamp
  double color_readout_s = 0;  // from the first row of colour to the last one
  double color_delay_s = 0;    // from the time stamp to the middle row of colour; negative: colour is earlier
  bool operator==(const ImageTiming&) const = default;
};

// Returns the position of an image row as a share of the readout: -0.5 in the first row, 0.5 in the last one.
inline double share_of_row(double row_px, int height_px) { return row_px / (height_px - 1) - 0.5; }

// Returns the velocity of a point that moves with the camera, for a camera's twist per second (translation part first).
inline Eigen::Vector3d velocity_of(const Eigen::Vector3d& point_m, const Vector6d& twist_per_s) {
  return twist_per_s.head<3>() + twist_per_s.tail<3>().cross(point_m);
}

// Returns the camera's twist per second, in its own coordinate frame at that time, so that its pose a time t later is
// world_from_camera * exp_se3(t * twist). It is taken between the poses before and after that of `timestamp_s`; at the
// ends of the trajectory and beside gaps, from one of them. std::nullopt if neither is at most kMaxPoseGap_s away, or
// if there is no pose at that time.
inline constexpr double kMaxPoseGap_s = 0.1;
inline constexpr double kSameTime_s = 1e-4;  // timestamps in a trajectory file are rounded to microseconds
std::optional<Vector6d> twist_per_s_at(const Trajectory& trajectory, double timestamp_s);

}  // namespace hermite
