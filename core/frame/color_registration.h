// Colour as the depth camera would see it, where another camera took it (Camera::color).
//
// Each pixel of the depth image is a point; its colour is between the four pixels of the colour image where that point lies.
//   - A pixel without depth takes the farthest depth of the smallest block around it (sides of 2, 4, 8, ... pixels) that has any: what has
//     no depth is mostly the projector's shadow of something near on something far, or too far to be measured.
//   - Where something nearer hides the point from the colour camera, the colour comes from the farther end of the hidden stretch of its
//     row: the near thing's colour would be wrong, and black would stay in the map as a colour.
#pragma once

#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite {

// Const functions are thread-safe.
class ColorRegistration {
 public:
  // CHECK: the camera has a colour camera of its own.
  explicit ColorRegistration(const Camera& camera);

  // `straight_depth` is of a lens without distortion, `color` as it arrived; both of the camera's size. Black beyond the colour image.
  ColorImage apply(const ColorImage& color, const DepthImage& straight_depth) const;

 private:
  // A pixel's point in the colour image [px], and how near it is.
  struct Place {
    float x = 0, y = 0;
    float inverse_depth_per_m = 0;
  };
  Place place_of(const Eigen::Vector3f& ray, float inverse_depth_per_m) const;
  std::vector<Place> places_of(const DepthImage& depth) const;
  std::vector<bool> hidden(const std::vector<Place>& places, const DepthImage& depth) const;

  const int width_, height_;  // pixels, of both images
  const float metres_per_depth_unit_;
  const ColorCamera color_;
  const bool color_is_distorted_;
  const Eigen::Matrix3f ray_from_pixel_;  // of the depth image; the ray is in the colour camera's frame, not of unit length
  const Eigen::Vector3f depth_camera_m_;  // in the colour camera's frame
  int cell_px_ = 0;                       // side of a cell of the depth buffer in the colour image
  float hiding_per_m_ = 0;                // how much greater the inverse depth of what hides a point is, at least
};

}  // namespace hermite
