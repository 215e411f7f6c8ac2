// Upright panes that stand in the scene, a mirror and one of glass: surfaces that depth cameras do not see as they are. For tests of
// tracking and of what maps make of them; the ground truth stays as it is.
//
// Written behind any source that has ground truth and depth registered to colour (open_sequence), with or without options:
//   +mirror       depth and colour are those of the reflection, which lies behind the mirror
//   +glass        depth is partly that of what lies behind the pane, partly missing, partly the pane's own where it is dirty; the picture
//   is
//                 that of what lies behind it, as it was
//     width_m, height_m   0.1 to 10 (mirror 0.8, glass 1)
//     distance_m  0.3 to 10 (1.6)     of the pane's middle, along the optical axis of the middle frame
//     turn_deg    -80 to 80 (mirror 45, glass 0)   about the upright axis, from facing the camera of the middle frame to the left
//     holes       0 to 1 (0.3)        glass only: share of the pane without depth: squares of 4 cm, others in every frame
//     specks      0 to 1 (0.05)       glass only: share of the pane that is seen: squares of 1 cm that stay where they are
//     seed        0 to 2^63 - 1 (1)   glass only
// What is nearer than the pane hides it; what has no depth is behind it. Behind its back a mirror is not there. The mirror shows what up to
// 24 frames, spread over the sequence, have seen of the room in front of it: their depth images as triangles, mirrored. What none of
// them has seen is dark and has no depth, and the camera does not see itself. Its depth has no noise: write +noise behind it. Up as in
// true_view.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite {

struct PaneOptions {
  double width_m = 0, height_m = 0, distance_m = 1.6, turn_deg = 0;
  double holes = 0.3, specks = 0.05;  // of glass
  std::uint64_t seed = 1;             // of glass
};

// "key=value,...", may be empty. kInvalidArgument, naming key and range.
Result<PaneOptions> parse_mirror(const std::string& text);
Result<PaneOptions> parse_glass(const std::string& text);

struct Pane {
  Eigen::Vector3d middle_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d across_world = Eigen::Vector3d::UnitX(), up_world = Eigen::Vector3d::UnitZ();  // unit, along its sides
  Eigen::Vector3d normal_world = Eigen::Vector3d::UnitY();                                       // unit, out of its front
  double half_width_m = 0, half_height_m = 0;

  Eigen::Vector3d mirrored(const Eigen::Vector3d& point_world) const {
    return point_world - 2 * (point_world - middle_world).dot(normal_world) * normal_world;
  }
};

// Where the pane stands. kInvalidArgument: there is no ground truth.
Result<Pane> pane_in(const Sequence& sequence, const PaneOptions& options);

// The same sequence with the pane. `options` as above; kInvalidArgument also without ground truth. kUnsupported: depth is not registered to
// colour. A frame without a pose within 0.1 s is an error of that frame.
Result<std::unique_ptr<Sequence>> with_mirror(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_glass(std::unique_ptr<Sequence> sequence, const std::string& options);

}  // namespace hermite
