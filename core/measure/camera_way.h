// How far the camera has gone between two places that it saw: what ties them together in a map, and what errors between them grow with.
// Made once; then const and thread-safe.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/dataset/trajectory.h"

namespace hermite {

class CameraWay {
 public:
  // The poses of a result, one a frame, in the world of its surfels. None: nothing is known of the way.
  explicit CameraWay(const Trajectory& trajectory);

  // The least way [m] along the path between a camera that may have seen one place and one that may have seen the other; 0: one has seen
  // both. A camera may have seen a place that lies within 38 degrees of where it looks, in front of it at 0.3 to 5 m, whose `normal`
  // points towards it; what stands between is not known here. Infinite: no camera has seen one of them.
  double between_m(const Eigen::Vector3d& place, const Eigen::Vector3d& normal, const Eigen::Vector3d& other_place,
                   const Eigen::Vector3d& other_normal) const;

 private:
  std::vector<bool> seen_from(const Eigen::Vector3d& place, const Eigen::Vector3d& normal) const;

  Trajectory trajectory_;
  std::vector<double> gone_m_;  // by pose
};

}  // namespace hermite
