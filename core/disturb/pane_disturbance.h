// Upright panes in the scene: a mirror or glass, which depth cameras do not measure correctly, a
// screen whose picture moves, and a door that swings. For tests of tracking and of their effect on
// maps; the ground truth is unchanged.
//
// Appended to any source that has ground truth and depth registered to colour (open_sequence), with
// or without options:
//   +mirror       depth and colour are those of the reflection, which is behind the mirror
//   +glass        depth is partly that of what is behind the pane, partly missing, and partly that
//                 of the pane where it is dirty; the colour is that of what is behind it, unchanged
//   +screen       a picture with checks of 12 cm that moves across an opaque pane
//   +door         an opaque pane that swings about its left edge, closed at the first frame
//     width_m, height_m   0.1 to 10 (mirror 0.8, glass 1, screen 1.2 x 0.7, door 0.9 x 2)
//     distance_m  0.3 to 10 (1.6)     of the pane's centre, along the optical axis of the middle
//                                     frame
//     turn_deg    -80 to 80 (mirror 45, glass 0)   about the upright axis, from facing the camera
//                 of the middle frame to the left
//     speed_m_s   -10 to 10 (0.3)     screen only
//     swing_deg   -170 to 170 (60)    door only: when it is widest open, after half a period
//     period_s    0.5 to 3600 (4)     door only
//     holes       0 to 1 (0.3)        glass only: share of the pane without depth: squares of 4 cm,
//                                     different in each frame
//     specks      0 to 1 (0.05)       glass only: share of the pane that is measured: squares of 1
//                                     cm that stay in place
//     seed        0 to 2^63 - 1 (1)   glass only
// Nearer surfaces hide the pane; pixels without depth are taken to be behind it. From its back a
// mirror is invisible. The mirror shows what up to 24 frames, spread over the sequence, have seen
// of the room in front of it: their depth images as triangles, mirrored. What none of them has seen
// is dark and has no depth, and the camera does not see itself. The reflection has no noise: append
// +noise after it. Up as in true_view.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

struct PaneOptions {
  double width_m = 0, height_m = 0, distance_m = 1.6, turn_deg = 0;
  double holes = 0.3, specks = 0.05;  // glass only
  std::uint64_t seed = 1;             // glass only
};

// Parse "key=value,..." or empty text. kInvalidArgument, naming key and range.
Result<PaneOptions> parse_mirror(const std::string& text);
Result<PaneOptions> parse_glass(const std::string& text);

struct Pane {
  Eigen::Vector3d middle_world = Eigen::Vector3d::Zero();
  // Unit vectors along its sides.
  Eigen::Vector3d across_world = Eigen::Vector3d::UnitX(), up_world = Eigen::Vector3d::UnitZ();
  // Unit vector out of its front.
  Eigen::Vector3d normal_world = Eigen::Vector3d::UnitY();
  double half_width_m = 0, half_height_m = 0;

  Eigen::Vector3d mirrored(const Eigen::Vector3d& point_world) const {
    return point_world - 2 * (point_world - middle_world).dot(normal_world) * normal_world;
  }
};

// Returns the position of the pane. kInvalidArgument without ground truth.
Result<Pane> pane_in(const dataset::Sequence& sequence, const PaneOptions& options);

// Return the same sequence with the pane. `options` as above; kInvalidArgument also without ground
// truth; kUnsupported when depth is not registered to colour. A frame without a pose within 0.1 s
// is an error of that frame.
Result<std::unique_ptr<dataset::Sequence>> with_mirror(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_glass(std::unique_ptr<dataset::Sequence> sequence,
                                                      const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_screen(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_door(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options);

}  // namespace hermite::disturb
