// Which way is up in a scan, from the normals of its surface: a room has floors, tables and
// ceilings across gravity, and walls along it. World: x right, y down, z forward of the first
// camera. Pure functions.
#pragma once

#include <Eigen/Core>
#include <numbers>
#include <optional>

#include "core/math/up_direction.h"
#include "core/output/cloud.h"

namespace hermite::thumbnail {

// Where up is looked for. Nothing known: a camera is held more or less upright.
struct UpRange {
  Eigen::Vector3f middle{0, -1, 0};  // unit vector; up of the first camera
  float most_off_rad = std::numbers::pi_v<float> / 3;
};

// Returns the range within three standard deviations of what was measured, at least 3 degrees,
// which floors may slope; of nothing, the default.
UpRange up_range(const std::optional<UpDirection>& measured);

// Returns the unit vector that points up in the world; none if the surface does not tell, as when
// it is too small, or no large part of it lies across or along one direction within the range.
// Looks at some thousand points, evenly over the cloud. Points without a normal are ignored.
std::optional<Eigen::Vector3f> up_direction(const output::Cloud& cloud, const UpRange& range = {});

// Returns the same, or else what was measured, or else up of the first camera.
Eigen::Vector3f best_up(const output::Cloud& cloud, const std::optional<UpDirection>& measured);

}  // namespace hermite::thumbnail
