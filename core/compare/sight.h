// Which places a scan's camera has looked through: the depth of its surfels as seen from its path.
// It tells "empty" from "never seen". Immutable after construction; thread-safe.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/image.h"
#include "core/compare/compared_scan.h"
#include "core/math/camera.h"

namespace hermite::compare {

class Sight {
 public:
  // Draws the surfels from at most kMostViews poses spread over the path. A result does not say
  // what camera made it: the field of view is assumed to be a Kinect's or smaller, 57 by 43
  // degrees. A camera that saw more is said to have seen less, so that less is called empty.
  // Without a trajectory nothing was looked through.
  explicit Sight(const ComparedScan& scan);

  static constexpr std::size_t kMostViews = 96;

  // Whether a surface was seen at least `margin_m` behind the place, in all pixels around it, from
  // one of the poses.
  bool looked_through(const Eigen::Vector3d& point_in_world, double margin_m) const;

  std::size_t view_count() const { return views_.size(); }

 private:
  struct View {
    Rigid3 camera_from_world;
    Image<float> depth_m;  // 0: nothing
  };
  View view_of(const SurfaceSamples& surface, const Rigid3& world_from_camera) const;
  bool looked_through(const View& view, const Eigen::Vector3d& point_in_world,
                      double margin_m) const;

  Camera camera_;
  std::vector<View> views_;
};

}  // namespace hermite::compare
