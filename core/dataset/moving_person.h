// Somebody who moves through the scene while it is scanned: an upright cylinder, 0.5 m wide and 1.75 m high, rendered into depth and colour
// from the poses of the ground truth; what is nearer hides it. For tests of tracking and of what a map keeps of things that move.
//
// Written behind any source (open_sequence), with or without options:
//   +person
//     path        cross, ahead (cross)   cross: walks through the view from right to left at 0.8 m/s, in the middle of it
//                                        at the middle frame; ahead: walks in front of the camera wherever that goes
//     clothes     checked, plain (checked)
//     distance_m  0.6 to 10 (1.9; ahead 1.7)   from the camera, of cross at the middle frame
//     still_s     0 to 60 (0)          stands for so long, from the first frame on, where the walk then begins
// The head is 0.15 m above the camera, of cross at the middle frame. Up is the axis of the world, with its sign, that is nearest to the
// mean of the camera's up. The depth has no noise: write +noise behind it. Ground truth stays that of the camera.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite {

enum class PersonPath { kCross, kAhead };
enum class PersonClothes { kChecked, kPlain };

struct PersonOptions {
  PersonPath path = PersonPath::kCross;
  PersonClothes clothes = PersonClothes::kChecked;
  double distance_m = 1.9;
  double still_s = 0;
  bool operator==(const PersonOptions&) const = default;
};

// A solid upright cylinder.
struct Person {
  Eigen::Vector3d head_world = Eigen::Vector3d::Zero();  // middle of its upper end
  double radius_m = 0, height_m = 0;
  Eigen::Vector3d up_world = Eigen::Vector3d::UnitZ();  // of unit length

  bool contains(const Eigen::Vector3d& point_world, double margin_m = 0) const {
    const Eigen::Vector3d from_head = point_world - head_world;
    const double above_head_m = from_head.dot(up_world);
    return above_head_m <= margin_m && above_head_m >= -height_m - margin_m &&
           (from_head - above_head_m * up_world).norm() <= radius_m + margin_m;
  }
};

// "key=value,...", may be empty. kInvalidArgument, naming key and range.
Result<PersonOptions> parse_person(const std::string& text);

// Where the person is in that frame of a sequence, with or without the person in it. kInvalidArgument: there is no ground truth.
// kNotFound: it has no pose within 0.1 s of the frame.
Result<Person> person_at(const Sequence& sequence, const PersonOptions& options, std::int64_t frame_index);

// The same sequence with the person. kInvalidArgument: options as above, no ground truth. kUnsupported: depth is not registered to colour.
// A frame without a pose within 0.1 s is an error of that frame.
Result<std::unique_ptr<Sequence>> with_person(std::unique_ptr<Sequence> sequence, const std::string& options);

}  // namespace hermite
