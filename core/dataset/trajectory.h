// Camera poses over time, and the TUM text format: lines "timestamp tx ty tz qx qy qz qw"; '#'
// starts a comment.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/math/rigid3.h"

namespace hermite::dataset {

struct TimedPose {
  double timestamp_s = 0;
  Rigid3 world_from_camera;
};
using Trajectory = std::vector<TimedPose>;  // ascending in time

// Times that differ by less are the same: files round them to microseconds.
inline constexpr double kSameTime_s = 1e-4;

// Errors name the line. Rejects numbers that are not finite, quaternions that are not of unit
// length within 1 %, and times that decrease.
Result<Trajectory> parse_tum_trajectory(const std::string& text);
Result<Trajectory> read_tum_trajectory(const std::string& path);

// Returns kInvalidArgument, beginning with `name`, for a pose that is not finite and for times that
// decrease.
Status validate(const Trajectory& trajectory, const std::string& name);

// Returns the pose at that time: interpolated between the poses before and after if both are at
// most `max_gap_s` away, else the one that is; std::nullopt if there is none. The exact time of a
// pose gives that pose.
std::optional<Rigid3> pose_at(const Trajectory& trajectory, double timestamp_s, double max_gap_s);

// Uses six decimals for the time and nine for the rest. Deterministic, so that its hash identifies
// a run.
std::string format_tum_trajectory(const Trajectory& trajectory);

}  // namespace hermite::dataset
