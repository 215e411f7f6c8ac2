// The camera's way through the larger scenes: a closed curve of way points, smooth to the fourth derivative.
#pragma once

#include "core/dataset/synthetic_room.h"
#include "core/math/rigid3.h"

namespace hermite {

// world_from_camera of a camera held upright: it looks along the heading (from x towards y), up by the pitch, and is then turned by the
// roll about where it looks.
Rigid3 camera_at(const Eigen::Vector3d& position_m, double heading_rad, double pitch_rad, double roll_rad);

// Duration of one lap at speed 1 [s]: as long as the way takes at 0.4 m/s, longer where the camera turns.
double world_lap_s(RoomScene scene);

// world_from_camera after `laps` laps, any number from 0 on. Height and pitch alternate between laps, so it repeats after two. Of kRoom,
// kBare, kTurntable and kPoster there is none: a CHECK fails. Thread-safe.
Rigid3 world_pose(RoomScene scene, double laps);

}  // namespace hermite
