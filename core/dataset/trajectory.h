// Camera poses over time, and the TUM text format: "timestamp tx ty tz qx qy qz qw" a line, '#' starts a comment.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/math/rigid3.h"

namespace hermite {

struct TimedPose {
  double timestamp_s = 0;
  Rigid3 world_from_camera;
};
using Trajectory = std::vector<TimedPose>;  // ascending in time

// Errors name the line. Rejects non-finite numbers, quaternions that are not of unit length within 1 %, and time running backwards.
Result<Trajectory> parse_tum_trajectory(const std::string& text);
Result<Trajectory> read_tum_trajectory(const std::string& path);

// Six decimals for the time, nine for the rest: deterministic, so that its hash identifies a run.
std::string format_tum_trajectory(const Trajectory& trajectory);

}  // namespace hermite
