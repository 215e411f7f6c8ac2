// A red square before a wall painted in smooth colours, as a depth camera and the colour camera
// beside it see them.
#pragma once

#include <cmath>

#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite::test {

// In metres, in the depth camera's frame; both faces are parallel to its image.
inline constexpr double kSquareDepth_m = 0.8, kWallDepth_m = 2.0, kSquareHalfSide_m = 0.15;
inline constexpr Rgb8 kSquareColor{250, 0, 0};

// Two pixels are less than a level of it.
inline Rgb8 wall_color(const Eigen::Vector3d& point) {
  return {0, static_cast<std::uint8_t>(128 + 50 * point.x()),
          static_cast<std::uint8_t>(128 + 60 * point.y())};
}

// The first face on the way from `origin` along `direction`.
inline Eigen::Vector3d first_point(const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction) {
  const auto at = [&](double depth_m) -> Eigen::Vector3d {
    return origin + direction * ((depth_m - origin.z()) / direction.z());
  };
  const Eigen::Vector3d on_square = at(kSquareDepth_m);
  return on_square.head<2>().cwiseAbs().maxCoeff() <= kSquareHalfSide_m ? on_square
                                                                        : at(kWallDepth_m);
}

inline bool is_on_square(const Eigen::Vector3d& point) { return point.z() < 1; }

// What the lens puts at `bent`, at z = 1: the distortion of small lenses inverted by iteration.
inline Eigen::Vector3d straight_ray(const Distortion& lens, const Eigen::Vector2d& bent) {
  Eigen::Vector2d straight = bent;
  for (int i = 0; i < 30; ++i) straight += bent - lens.apply(straight.x(), straight.y());
  return {straight.x(), straight.y(), 1};
}

// As both images arrive.
inline frame::RgbdFrame two_lens_frame(const Camera& camera) {
  frame::RgbdFrame frame{0.5, DepthImage(camera.width, camera.height),
                         ColorImage(camera.width, camera.height)};
  const ColorCamera& color = *camera.color;
  const Rigid3 depth_from_color = inverse(color.color_from_depth);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = straight_ray(
          camera.distortion, {(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy});
      const Eigen::Vector3d seen = first_point(Eigen::Vector3d::Zero(), ray);
      frame.depth.at(x, y) =
          static_cast<std::uint16_t>(std::lround(seen.z() * camera.depth_units_per_metre));
      const Eigen::Vector3d color_ray =
          straight_ray(color.distortion, {(x - color.cx) / color.fx, (y - color.cy) / color.fy});
      const Eigen::Vector3d colored =
          first_point(depth_from_color.translation, depth_from_color.rotation * color_ray);
      frame.color.at(x, y) = is_on_square(colored) ? kSquareColor : wall_color(colored);
    }
  return frame;
}

// Points seen by straight pixels of the depth image.
inline Eigen::Vector3d point_of(const Camera& camera, int x, int y) {
  return first_point(Eigen::Vector3d::Zero(), camera.unproject(x, y, 1));
}

// Away from the lines on which the square's edges lie: there depth is that of the nearest pixel and
// colour is mixed.
inline bool is_inside_a_face(const Camera& camera, int x, int y, double margin_px) {
  const double half_x_px = camera.fx * kSquareHalfSide_m / kSquareDepth_m,
               half_y_px = camera.fy * kSquareHalfSide_m / kSquareDepth_m;
  return std::abs(std::abs(x - camera.cx) - half_x_px) > margin_px &&
         std::abs(std::abs(y - camera.cy) - half_y_px) > margin_px;
}

}  // namespace hermite::test
