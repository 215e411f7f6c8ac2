// Camera poses over time, and the TUM text format: "timestamp tx ty tz qx qy qz qw" a line, '#' starts a comment.
#pragma once

#include <optional>
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

// kInvalidArgument, beginning with `name`: a pose that is not finite, time running backwards.
Status validate(const Trajectory& trajectory, const std::string& name);

// Where the camera was at that time: between the poses before and after when both are at most `max_gap_s` away, else the one that is;
// none when there is no such pose. A time that a pose has gets that pose.
std::optional<Rigid3> pose_at(const Trajectory& trajectory, double timestamp_s, double max_gap_s);

// Six decimals for the time, nine for the rest: deterministic, so that its hash identifies a run.
std::string format_tum_trajectory(const Trajectory& trajectory);

}  // namespace hermite
