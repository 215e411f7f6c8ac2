#include "core/dataset/camera_velocity.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hermite::dataset {

std::optional<Vector6d> twist_per_s_at(const Trajectory& trajectory, double timestamp_s) {
  const auto time_of = [](const TimedPose& pose) { return pose.timestamp_s; };
  const auto here = std::ranges::lower_bound(trajectory, timestamp_s - kSameTime_s, {}, time_of);
  if (here == trajectory.end() || here->timestamp_s > timestamp_s + kSameTime_s)
    return std::nullopt;
  const auto is_near = [&](auto other) {
    return std::abs(other->timestamp_s - here->timestamp_s) <= kMaxVelocityGap_s;
  };
  auto from = here, to = here;
  if (here != trajectory.begin() && is_near(std::prev(here))) --from;
  if (std::next(here) != trajectory.end() && is_near(std::next(here))) ++to;
  if (!(to->timestamp_s > from->timestamp_s)) return std::nullopt;
  return log_se3(inverse(from->world_from_camera) * to->world_from_camera) /
         (to->timestamp_s - from->timestamp_s);
}

}  // namespace hermite::dataset
