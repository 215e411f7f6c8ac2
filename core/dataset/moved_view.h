// What a camera would have seen from a place near the one where a frame was taken, by what that frame shows: its pixels re-projected.
// Exact where one surface fills the view between the two places, to the rounding of the frame's own depth. What the frame does not show,
// beyond its border and behind its edges, has no depth; there the colour is that of the nearest pixel that it has. What has no depth is
// taken to be infinitely far. Things are taken to stand still between the two.
#pragma once

#include <Eigen/Core>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite {

// Where a frame shows what a moved camera sees in a pixel.
struct SeenPlace {
  Eigen::Vector2d at_px = Eigen::Vector2d::Zero();  // in the frame, inside its image
  double depth_m = 0;                               // for the moved camera; 0: not known
};

// Refers to its arguments. Const functions are thread-safe.
class MovedView {
 public:
  // `rays`: rays_of(camera).
  MovedView(const Camera& camera, const Image<Eigen::Vector3d>& rays, const DepthImage& depth)
      : camera_(camera), rays_(rays), depth_(depth) {}

  // Of a pixel of the moved camera.
  SeenPlace find(int x, int y, const Rigid3& frame_from_moved) const;

 private:
  double depth_at_m(const Eigen::Vector2d& at_px) const;

  const Camera& camera_;
  const Image<Eigen::Vector3d>& rays_;
  const DepthImage& depth_;
};

// Between the four pixels around a place inside the image; 0 to 255.
Eigen::Vector3d color_at(const ColorImage& color, const Eigen::Vector2d& at_px);

// Rounded and cut to 0 to 255.
Rgb8 rounded(const Eigen::Vector3d& color);

}  // namespace hermite
