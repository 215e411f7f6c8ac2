// The view of a camera from a position near that of a recorded frame, made from the pixels of that
// frame. Where one surface fills the view between the two positions it is exact to the rounding of
// the frame's depth. Where the frame shows nothing, beyond its border and behind its edges, there
// is no depth, and the colour is that of the nearest pixel. Pixels without depth are taken to be
// infinitely far. Objects are assumed not to move between the two.
#pragma once

#include <Eigen/Core>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite::disturb {

// The position in a frame of what a moved camera sees in a pixel.
struct SeenPlace {
  Eigen::Vector2d at_px = Eigen::Vector2d::Zero();  // in the frame, inside its image
  double depth_m = 0;                               // for the moved camera; 0: unknown
};

// Holds references to its arguments. Const functions are thread-safe.
class MovedView {
 public:
  // `rays` are rays_of(camera).
  MovedView(const Camera& camera, const Image<Eigen::Vector3d>& rays, const DepthImage& depth)
      : camera_(camera), rays_(rays), depth_(depth) {}

  // Returns the position for a pixel of the moved camera.
  SeenPlace find(int x, int y, const Rigid3& frame_from_moved) const;

 private:
  double depth_at_m(const Eigen::Vector2d& at_px) const;

  const Camera& camera_;
  const Image<Eigen::Vector3d>& rays_;
  const DepthImage& depth_;
};

// Interpolates between the four pixels around a position inside the image; 0 to 255.
Eigen::Vector3d color_at(const ColorImage& color, const Eigen::Vector2d& at_px);

// Rounds and clamps to 0 to 255.
Rgb8 rounded(const Eigen::Vector3d& color);

}  // namespace hermite::disturb
