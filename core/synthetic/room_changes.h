// Changes of a synthetic scene between two visits: named objects that were moved or taken away.
// Pure functions.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/synthetic/room_furniture.h"

namespace hermite::synthetic {

// An object moves at most this far along each axis of the world.
inline constexpr double kMostMove_m = 1;

struct RoomChange {
  std::string object;  // one of Furniture::objects
  Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();
  bool is_removed = false;
};

// Reads "OBJECT:DX:DY:DZ/OBJECT:DX:DY:DZ" in millimetres, and "OBJECT/OBJECT". kInvalidArgument,
// naming the part and what is allowed.
Result<std::vector<RoomChange>> parse_moved_objects(std::string_view text);
std::vector<RoomChange> parse_removed_objects(std::string_view text);

// Applies the changes in order. The lights stay as they are. kInvalidArgument, naming the objects
// that there are, for an object that the scene does not have or that was removed before. An object
// that was first moved may be removed.
Status apply_changes(const std::vector<RoomChange>& changes, Furniture& furniture);

}  // namespace hermite::synthetic
