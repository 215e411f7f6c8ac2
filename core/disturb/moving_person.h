// A person who moves through the scene while it is scanned: an upright cylinder, 0.5 m wide
// and 1.75 m high, rendered into depth and colour from the poses of the ground truth; nearer
// surfaces hide it. For tests of tracking and of how moving objects affect the map.
//
// Appended to any source (open_sequence), with or without options:
//   +person
//     path        cross, ahead (cross)   cross: walks through the view from right to left at 0.8
//                                        m/s, in the middle of it at the middle frame; ahead: walks
//                                        in front of the camera wherever that goes
//     clothes     checked, plain (checked)
//     distance_m  0.6 to 10 (1.9; ahead 1.7)   from the camera; for cross, at the middle frame
//     still_s     0 to 60 (0)          time from the first frame on for which the person stands
//                                      where the walk then begins
// The head is 0.15 m above the camera; for cross, at the middle frame. Up is the signed axis of the
// world that is nearest to the mean of the camera's up direction. The depth has no noise: append
// +noise after it. The ground truth remains that of the camera.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

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
  Eigen::Vector3d head_world = Eigen::Vector3d::Zero();  // centre of its upper end
  double radius_m = 0, height_m = 0;
  Eigen::Vector3d up_world = Eigen::Vector3d::UnitZ();  // unit vector

  bool contains(const Eigen::Vector3d& point_world, double margin_m = 0) const {
    const Eigen::Vector3d from_head = point_world - head_world;
    const double above_head_m = from_head.dot(up_world);
    return above_head_m <= margin_m && above_head_m >= -height_m - margin_m &&
           (from_head - above_head_m * up_world).norm() <= radius_m + margin_m;
  }
};

// Parses "key=value,..." or empty text. kInvalidArgument, naming key and range.
Result<PersonOptions> parse_person(const std::string& text);

// Returns the position of the person in that frame of a sequence, with or without the person in it.
// kInvalidArgument without ground truth; kNotFound when it has no pose within 0.1 s of the frame.
Result<Person> person_at(const dataset::Sequence& sequence, const PersonOptions& options,
                         std::int64_t frame_index);

// Returns the same sequence with the person. kInvalidArgument for options, and without ground
// truth; kUnsupported when depth is not registered to colour. A frame without a pose within 0.1 s
// is an error of that frame.
Result<std::unique_ptr<dataset::Sequence>> with_person(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);

}  // namespace hermite::disturb
