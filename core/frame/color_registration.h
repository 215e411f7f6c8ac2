// Registers the image of a separate colour camera (Camera::color) to the depth image.
//
// Each pixel of the depth image is a point; its colour is interpolated between the four pixels of
// the colour image around the point's projection.
//  - A pixel without depth gets the farthest depth of the smallest block around it (sides of 2, 4,
//    8, ... pixels) that has any, because missing depth is mostly the projector's shadow of a near
//    object on a far one, or out of range.
//  - If something nearer occludes the point in the colour camera, its colour is taken from the
//    farther end of the occluded stretch of its row: the near object's colour would be wrong, and
//    black would stay in the map. Occlusion is only found within rows, because the lenses of known
//    devices are side by side; for lenses above each other, near colours leak.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite::frame {

// Const functions are thread-safe.
class ColorRegistration {
 public:
  // A CHECK fails unless the camera has a separate colour camera.
  explicit ColorRegistration(const Camera& camera);

  // Returns the registered colour image, whose border continues where it ends. `straight_depth` is
  // rectified and `color` is as recorded; both have the camera's size.
  ColorImage apply(const ColorImage& color, const DepthImage& straight_depth) const;

 private:
  using InverseDepths = Image<float>;  // 1/m
  struct Row {
    Eigen::ArrayXf u, v;  // projections of the pixels' points in the colour image [px]
    // By column of the colour image, with margins: inverse depth of the nearest point there.
    Eigen::ArrayXf nearest_per_m;
    // By column: the maximum over all points that may cover this column or the next.
    Eigen::ArrayXf covering_per_m;
    std::vector<std::uint8_t> is_hidden;
  };
  void find_places(const InverseDepths& inverse_depths, int y, Row& row) const;
  void find_hidden(const InverseDepths& inverse_depths, const DepthImage& depth, int y,
                   Row& row) const;
  void uncover(const InverseDepths& inverse_depths, int y, const Row& row,
               ColorImage& registered) const;

  const int width_, height_;  // pixels, of both images
  const float metres_per_depth_unit_;
  const Distortion distortion_;  // of the colour lens
  const bool is_distorted_;
  const float fx_, fy_, cx_, cy_;  // of the colour camera [px]
  // From the depth image to a ray in the colour camera's frame, of arbitrary length.
  const Eigen::Matrix3f ray_from_pixel_;
  const Eigen::Vector3f depth_camera_m_;  // in the colour camera's frame
  const Eigen::ArrayXf columns_;          // 0, 1, 2, ... of a row
  const int reach_px_;                    // half the width of a depth pixel in the colour image
  // Columns beside the colour image whose points may reach into it.
  const int margin_px_;
  const float hiding_per_m_;  // least difference of inverse depth for an occlusion
};

}  // namespace hermite::frame
