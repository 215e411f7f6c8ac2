#include "core/pipeline/camera_pace.h"

#include <algorithm>
#include <cmath>

namespace hermite::pipeline {

// A mean over about a second, in which a gap counts little however long it was.
void CameraPace::count_interval(double interval_s, bool is_first) {
  constexpr double kNew = 1.0 / 32, kMostTimes = 4, kShortest_s = 0.01;
  if (is_first)
    usual_interval_s_ = std::max(0.0, interval_s);
  else
    usual_interval_s_ =
        usual_interval_s_ +
        kNew * (std::clamp(interval_s, 0.0, kMostTimes * usual_interval_s_ + kShortest_s) -
                usual_interval_s_);
}

void CameraPace::step(double timestamp_s, const std::optional<Rigid3>& last_from_camera) {
  last_twist_per_s_ = last_from_camera && timestamp_s > last_tracked_s_
                          ? Vector6d(log_se3(*last_from_camera) / (timestamp_s - last_tracked_s_))
                          : Vector6d::Zero();
  last_tracked_s_ = timestamp_s;
}

double CameraPace::unseen_s(double timestamp_s) const {
  return std::max(0.0, timestamp_s - last_tracked_s_ - usual_interval_s_);
}

bool CameraPace::is_valid() const {
  return std::isfinite(last_tracked_s_) && std::isfinite(usual_interval_s_) &&
         usual_interval_s_ >= 0 && last_twist_per_s_.allFinite();
}

}  // namespace hermite::pipeline
