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

  // Of each pose whether its camera may have seen a place: one that lies within 38 degrees of where it looks, in front of it at 0.3 to 5 m,
  // whose `normal` points towards it; what stands between is not known here.
  std::vector<bool> seen_from(const Eigen::Vector3d& place, const Eigen::Vector3d& normal) const;

  // The least way [m] along the path between a camera that may have seen one place and one that may have seen the other, each as seen_from
  // has it; 0: one has seen both. Infinite: no camera has seen one of them.
  double between_m(const std::vector<bool>& seen, const std::vector<bool>& other_seen) const;

 private:
  Trajectory trajectory_;
  std::vector<double> gone_m_;  // by pose
};

}  // namespace hermite
