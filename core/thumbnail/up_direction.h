// Which way is up in a scan, from the normals of its surface: a room has floors, tables and
// ceilings across gravity, and walls along it. World: x right, y down, z forward of the first
// camera. Pure functions.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/output/cloud.h"

namespace hermite::thumbnail {

// A camera is held more or less upright.
inline Eigen::Vector3f up_of_first_camera() { return {0, -1, 0}; }

// Returns the unit vector that points up in the world; none if the surface does not tell, as when
// it is too small, or no large part of it lies across or along one direction within 60 degrees of
// the first camera's up. Looks at some thousand points, evenly over the cloud. Points without a
// normal are ignored.
std::optional<Eigen::Vector3f> up_direction(const output::Cloud& cloud);

}  // namespace hermite::thumbnail
