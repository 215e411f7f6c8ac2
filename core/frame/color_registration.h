// Colour as the depth camera would see it, where another camera took it (Camera::color).
//
// Each pixel of the depth image is a point; its colour is between the four pixels of the colour image where that point lies.
//   - A pixel without depth takes the farthest depth of the smallest block around it (sides of 2, 4, 8, ... pixels) that has any: what has
//     no depth is mostly the projector's shadow of something near on something far, or too far to be measured.
//   - Where something nearer hides the point from the colour camera, the colour comes from the farther end of the hidden stretch of its
//     row: the near thing's colour would be wrong, and black would stay in the map as a colour. Found row by row: the lenses of known
//     devices sit side by side, so that what hides a point lies in its row. Of lenses one above the other, near colours leak.
#pragma once

#include <Eigen/Core>
#include <cstdint>
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
  using InverseDepths = Image<float>;  // 1/m
  struct Row {
    Eigen::ArrayXf u, v;            // where the pixels' points lie in the colour image [px]
    Eigen::ArrayXf nearest_per_m;   // by column of the colour image, with margins: inverse depth of the nearest thing measured there
    Eigen::ArrayXf covering_per_m;  // by column: the same of all that may cover it or the next
    std::vector<std::uint8_t> is_hidden;
  };
  void find_places(const InverseDepths& inverse_depths, int y, Row& row) const;
  void find_hidden(const InverseDepths& inverse_depths, const DepthImage& depth, int y, Row& row) const;
  void uncover(const InverseDepths& inverse_depths, int y, const Row& row, ColorImage& registered) const;

  const int width_, height_;  // pixels, of both images
  const float metres_per_depth_unit_;
  const Distortion distortion_;  // of the colour lens
  const bool is_distorted_;
  const float fx_, fy_, cx_, cy_;         // of the colour camera [px]
  const Eigen::Matrix3f ray_from_pixel_;  // of the depth image; the ray is in the colour camera's frame, its length of no meaning
  const Eigen::Vector3f depth_camera_m_;  // in the colour camera's frame
  const Eigen::ArrayXf columns_;          // 0, 1, 2, ... of a row
  const int reach_px_;                    // how far a pixel of the depth image covers the colour image to either side of its place
  const int margin_px_;                   // beside the columns of the colour image: what lies there may reach into it
  const float hiding_per_m_;              // what hides a point is nearer by at least so much, in inverse depth
};

}  // namespace hermite
