// A camera carried through a synthetic scene (synthetic_room.h): a sequence with exact poses and an
// exact surface, without a recording. For demos, load tests and as the ground truth of accuracy
// tests.
//
// "synthetic[:key=value,...]":
//   frames    1 to 1000000 (300)          number of frames; a lap takes 10 s in the room at speed
//                                         1, in larger scenes 44 to 62 s
//   width, height  64 to 2048 (640x480)   pixels; the horizontal field of view is always 62.7
//                                         degrees
//   rate      1 to 240 (30)               frames per second
//   start     0 to 10000 (0)              seconds on the path at which the first frame is taken:
//                                         another path of the same camera
//   speed     0.05 to 5 (1)               of the hand: 1 is about 0.45 m/s and 37 degrees/s; more
//                                         frames mean more laps, not a faster hand
//   noise     none, gaussian, kinect, kinect-white (none)   see depth_noise.h
//   sigma_mm  0 to 200 (3)                only for noise=gaussian
//   seed      0 to 2^63 - 1 (1)           of the noise
//   scene     room, bare, loop, twins, office, blank, turntable, poster (room)   bare: the same
//             room without furniture; the others in synthetic_room.h
//   moved     OBJECT:DX:DY:DZ/...          objects that stand elsewhere than usual [mm], see
//                                          room_changes.h; in scene=room: lamp, sofa, desk, screen,
//                                          mug, chair, chair2, door, plant, divider, table, vase,
//                                          globe, ring, cabinet, bowl, jar, ball, blocks
//   removed   OBJECT/...                   objects that are not there
// With scene=turntable the camera stands still and a plate with objects turns in front of it, once
// in 20 s at speed 1. Its ground truth is in the coordinate frame of the plate, z up, the axis at x
// = y = 0: the camera moves around the objects as if they stood still. So a program that takes
// table and wall for the world is wrong by the motion that the camera did not make. Only objects on
// the plate have their exact surface, as at the first frame. Disturbances that use true poses treat
// table and wall as turning with the plate.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/dataset/sequence.h"
#include "core/disturb/depth_noise.h"
#include "core/synthetic/room_changes.h"
#include "core/synthetic/synthetic_room.h"

namespace hermite::synthetic {

struct SyntheticOptions {
  std::int64_t frame_count = 300;
  Camera camera{640, 480, 525, 525, 319.5, 239.5, 5000};
  double frame_rate_hz = 30;
  double speed = 1;
  double start_s = 0;
  RoomScene scene = RoomScene::kRoom;
  std::vector<RoomChange> changes;
  disturb::NoiseOptions noise;
};

// `text` is the part after "synthetic:" or empty. kInvalidArgument, naming key and range.
Result<SyntheticOptions> parse_synthetic_options(const std::string& text);

// Returns world_from_camera at a time: a closed lap whose height and pitch alternate between laps,
// so it repeats after two. In kRoom and kBare a lap takes 10 s / speed and is smooth in every
// derivative, in kTurntable it takes 20 s / speed; elsewhere world_paths.h gives the duration, and
// it is smooth to the fourth derivative. The world is the scene's: z up, the floor at z = 0.
Rigid3 synthetic_pose(double time_s, double speed, RoomScene scene = RoomScene::kRoom);

// Returns the name as in scene=, such as "loop".
const char* name_of(RoomScene scene);

// Returns the duration of a lap at speed 1 [s].
double synthetic_lap_s(RoomScene scene);

// kInvalidArgument for a camera that validate() rejects. Frames are rendered when they are read;
// the ground truth has a pose per frame.
Result<std::unique_ptr<dataset::Sequence>> make_synthetic_sequence(const SyntheticOptions& options);

}  // namespace hermite::synthetic
