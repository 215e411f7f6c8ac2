// The camera's path through the larger scenes: a closed curve of way points, smooth to the fourth
// derivative.
#pragma once

#include "core/math/rigid3.h"
#include "core/synthetic/synthetic_room.h"

namespace hermite::synthetic {

// Returns world_from_camera of an upright camera: it looks along the heading (from x towards y), up
// by the pitch, and is then rotated by the roll about its viewing direction.
Rigid3 camera_at(const Eigen::Vector3d& position_m, double heading_rad, double pitch_rad,
                 double roll_rad);

// Returns the duration of one lap at speed 1 [s]: as long as the path takes at 0.4 m/s, longer
// where the camera turns.
double world_lap_s(RoomScene scene);

// Returns world_from_camera after `laps` laps, any number from 0 on. Height and pitch alternate
// between laps, so it repeats after two. CHECK: not kRoom, kBare, kTurntable or kPoster, which have
// no such path. Thread-safe.
Rigid3 world_pose(RoomScene scene, double laps);

}  // namespace hermite::synthetic
