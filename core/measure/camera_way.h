// The camera's path between two places that it saw: it connects them in a map, and errors between
// them grow with its length. Const and thread-safe after construction.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/dataset/trajectory.h"

namespace hermite::measure {

class CameraWay {
 public:
  // Takes the poses of a result, one per frame, in the world of its surfels. Empty: nothing is
  // known of the path.
  explicit CameraWay(const dataset::Trajectory& trajectory);

  // Returns, by pose, whether its camera may have seen a place: the place is within 38 degrees of
  // the optical axis, 0.3 to 5 m in front of the camera, and its `normal` points towards the
  // camera. Occlusion is not considered.
  std::vector<bool> seen_from(const Eigen::Vector3d& place, const Eigen::Vector3d& normal) const;

  // Returns the shortest length [m] of the path between a camera that may have seen one place and a
  // camera that may have seen the other, each as given by seen_from; 0 if one camera may have seen
  // both, infinity if no camera can have seen one of them.
  double between_m(const std::vector<bool>& seen, const std::vector<bool>& other_seen) const;

 private:
  dataset::Trajectory trajectory_;
  std::vector<double> gone_m_;  // path length up to each pose
};

}  // namespace hermite::measure
