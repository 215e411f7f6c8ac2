// When the pixels of a frame are taken, relative to its time stamp. Plain values, pure functions,
// any thread.
//
// A rolling shutter takes each row at its own time, and the colour and depth cameras of a device
// are not always synchronous. Over one frame the camera is taken to move at a constant velocity: at
// 30 frames per second and a hand's acceleration of 1 m/s^2 it deviates from that by 0.1 mm.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/math/rigid3.h"

namespace hermite {

// The longest readout is that of a camera with 10 frames per second. A colour image that is later
// than that belongs to the next frame.
inline constexpr double kMaxReadout_s = 0.1, kMaxColorDelay_s = 0.1;

struct ImageTiming {
  // Time from the first row of depth to the last one; the middle row has the time stamp. Negative:
  // a camera upside down.
  double depth_readout_s = 0;
  double color_readout_s = 0;  // from the first row of colour to the last one
  // Time from the time stamp to the middle row of colour; negative: colour is earlier.
  double color_delay_s = 0;
  bool operator==(const ImageTiming&) const = default;

  // Returns when an image row is taken, after the time stamp.
  double depth_time_s(double row_px, int height_px) const;
  double color_time_s(double row_px, int height_px) const;
};

// Returns the position of an image row as a share of the readout: -0.5 in the first row, 0.5 in the
// last one.
inline double share_of_row(double row_px, int height_px) { return row_px / (height_px - 1) - 0.5; }

inline double ImageTiming::depth_time_s(double row_px, int height_px) const {
  return depth_readout_s * share_of_row(row_px, height_px);
}
inline double ImageTiming::color_time_s(double row_px, int height_px) const {
  return color_delay_s + color_readout_s * share_of_row(row_px, height_px);
}

// Returns the velocity of a point that moves with the camera, for a camera's twist per second
// (translation part first).
inline Eigen::Vector3d velocity_of(const Eigen::Vector3d& point_m, const Vector6d& twist_per_s) {
  return twist_per_s.head<3>() + twist_per_s.tail<3>().cross(point_m);
}

}  // namespace hermite
