#include "core/measure/camera_way.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hermite::measure {

namespace {

// Depth cameras have a field of view of 57 to 70 by 43 to 55 degrees, which is 74 to 80 degrees
// across the image diagonal.
constexpr double kHalfView_rad = 38 * std::numbers::pi / 180;
constexpr double kNearest_m = 0.3, kFarthest_m = 5;

}  // namespace

CameraWay::CameraWay(const dataset::Trajectory& trajectory) : trajectory_(trajectory) {
  double gone_m = 0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (i > 0)
      gone_m += (trajectory[i].world_from_camera.translation -
                 trajectory[i - 1].world_from_camera.translation)
                    .norm();
    gone_m_.push_back(gone_m);
  }
}

std::vector<bool> CameraWay::seen_from(const Eigen::Vector3d& place,
                                       const Eigen::Vector3d& normal) const {
  std::vector<bool> seen;
  for (const dataset::TimedPose& pose : trajectory_) {
    const Eigen::Vector3d towards = place - pose.world_from_camera.translation;
    const double depth_m = towards.dot(pose.world_from_camera.rotation * Eigen::Vector3d::UnitZ());
    seen.push_back(depth_m >= kNearest_m && depth_m <= kFarthest_m &&
                   depth_m >= std::cos(kHalfView_rad) * towards.norm() && normal.dot(towards) < 0);
  }
  return seen;
}

double CameraWay::between_m(const std::vector<bool>& seen,
                            const std::vector<bool>& other_seen) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  double least_m = kNever, last_m = -kNever, last_other_m = -kNever;
  for (std::size_t i = 0; i < gone_m_.size(); ++i) {
    if (seen[i]) last_m = gone_m_[i];
    if (other_seen[i]) last_other_m = gone_m_[i];
    if (seen[i]) least_m = std::min(least_m, gone_m_[i] - last_other_m);
    if (other_seen[i]) least_m = std::min(least_m, gone_m_[i] - last_m);
  }
  return least_m;
}

}  // namespace hermite::measure
