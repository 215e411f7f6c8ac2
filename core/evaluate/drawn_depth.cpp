#include "core/evaluate/drawn_depth.h"

#include <algorithm>
#include <cmath>

namespace hermite::evaluate {

namespace {

using Eigen::Vector3d;

struct DrawnCorner {
  double u = 0, v = 0;       // pixels
  double inverse_depth = 0;  // 1/m
};

double twice_the_area(const DrawnCorner& a, const DrawnCorner& b, double u, double v) {
  return (a.u - u) * (b.v - v) - (a.v - v) * (b.u - u);
}

void draw_triangle(const std::array<DrawnCorner, 3>& corners, Image<float>& depth_m) {
  const auto& [a, b, c] = corners;
  const double area = twice_the_area(b, c, a.u, a.v);
  if (area == 0) return;
  const auto first = [](double low) { return static_cast<int>(std::ceil(std::max(low, 0.0))); };
  const auto last = [](double high, int size) {
    return static_cast<int>(std::floor(std::min(high, size - 1.0)));
  };
  const int left = first(std::min({a.u, b.u, c.u})),
            right = last(std::max({a.u, b.u, c.u}), depth_m.width);
  const int top = first(std::min({a.v, b.v, c.v})),
            bottom = last(std::max({a.v, b.v, c.v}), depth_m.height);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const double share_a = twice_the_area(b, c, x, y) / area,
                   share_b = twice_the_area(c, a, x, y) / area;
      const double share_c = 1 - share_a - share_b;
      if (share_a < 0 || share_b < 0 || share_c < 0) continue;
      // In the image, the inverse depth of a plane is linear.
      const auto here_m = static_cast<float>(
          1 / (share_a * a.inverse_depth + share_b * b.inverse_depth + share_c * c.inverse_depth));
      float& pixel = depth_m.at(x, y);
      if (pixel == 0 || here_m < pixel) pixel = here_m;
    }
}

// Clips a triangle at the near plane (Sutherland and Hodgman): no, three or four corners remain.
std::size_t clip(const std::array<Vector3d, 3>& corners, std::array<Vector3d, 4>& clipped) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d &from = corners[i], &to = corners[(i + 1) % 3];
    if (from.z() >= kNearestDrawnDepth_m) clipped[count++] = from;
    if ((from.z() >= kNearestDrawnDepth_m) == (to.z() >= kNearestDrawnDepth_m)) continue;
    clipped[count++] = from + (kNearestDrawnDepth_m - from.z()) / (to.z() - from.z()) * (to - from);
  }
  return count;
}

}  // namespace

Image<float> drawn_depth_m(const std::vector<Triangle>& triangles_in_world, const Camera& camera,
                           const Rigid3& world_from_camera) {
  Image<float> depth_m(camera.width, camera.height);
  const Rigid3 camera_from_world = inverse(world_from_camera);
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  for (const Triangle& triangle : triangles_in_world) {
    std::array<Vector3d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = rotation * triangle[i].cast<double>() + camera_from_world.translation;
    if (!(corners[0].allFinite() && corners[1].allFinite() && corners[2].allFinite())) continue;
    std::array<Vector3d, 4> clipped;
    const std::size_t count = clip(corners, clipped);
    std::array<DrawnCorner, 4> drawn;
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector2d at = camera.project(clipped[i]);
      drawn[i] = {at.x(), at.y(), 1 / clipped[i].z()};
    }
    for (std::size_t i = 2; i < count; ++i)
      draw_triangle({drawn[0], drawn[i - 1], drawn[i]}, depth_m);
  }
  return depth_m;
}

}  // namespace hermite::evaluate
