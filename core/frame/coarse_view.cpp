#include "core/frame/coarse_view.h"

#include <algorithm>
#include <cmath>

namespace hermite::frame {

namespace {

// Unpacks as shaders/lib/geometry.glsl: x and y as 2 x snorm16, z is not negative.
Eigen::Vector3f unpack_normal(shared::uint packed) {
  const auto number = [](shared::uint bits) {
    return static_cast<float>(static_cast<std::int16_t>(bits & 0xffffu)) / 32767.0f;
  };
  const float x = number(packed), y = number(packed >> 16);
  return {x, y, std::sqrt(std::max(0.0f, 1 - x * x - y * y))};
}

}  // namespace

Eigen::Vector3d CoarseView::point(int x, int y) const {
  return depth_m[index(x, y)] * Eigen::Vector3d((x - double{camera.cx}) / double{camera.fx},
                                                (y - double{camera.cy}) / double{camera.fy}, 1);
}

Eigen::Vector2d CoarseView::project(const Eigen::Vector3d& point) const {
  return {camera.fx * point.x() / point.z() + camera.cx,
          camera.fy * point.y() / point.z() + camera.cy};
}

std::vector<Eigen::Vector3d> points_of(const CoarseView& view) {
  std::vector<Eigen::Vector3d> points(view.size());
  for (int y = 0; y < static_cast<int>(view.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(view.camera.width); ++x)
      points[view.index(x, y)] = view.point(x, y);
  return points;
}

CoarseView coarse_view(const SurfacePyramid& surface) {
  const SurfaceLevel& level = surface.levels.back();
  const std::size_t pixels = std::size_t{level.camera.width} * level.camera.height;
  std::vector<shared::SurfacePoint> points(pixels);
  level.points.download_into(points);
  CoarseView view{level.camera, std::vector<float>(pixels),
                  std::vector<Eigen::Vector3f>(pixels, Eigen::Vector3f::Zero()),
                  std::vector<float>(pixels)};
  level.intensity.download_into(view.grey);
  for (std::size_t i = 0; i < pixels; ++i) {
    view.depth_m[i] = points[i].depth_m;
    if (points[i].depth_m > 0) view.normals[i] = unpack_normal(points[i].normal);
  }
  return view;
}

void save(ByteWriter& bytes, const CoarseView& view) {
  bytes.number(view.camera);
  bytes.numbers(view.depth_m);
  std::vector<float> normals(3 * view.normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i)
    normals[i] = view.normals[i / 3][static_cast<Eigen::Index>(i % 3)];
  bytes.numbers(normals);
  bytes.numbers(view.grey);
}

void restore(ByteReader& bytes, CoarseView& view) {
  std::vector<float> normals;
  bytes.number(view.camera);
  bytes.numbers(view.depth_m);
  bytes.numbers(normals);
  bytes.numbers(view.grey);
  const std::uint64_t pixels = std::uint64_t{view.camera.width} * view.camera.height;
  const bool fits =
      view.depth_m.size() == pixels && normals.size() == 3 * pixels && view.grey.size() == pixels;
  bytes.require(fits, "the pixels of a coarse view are inconsistent");
  if (!fits) return;
  view.normals.resize(static_cast<std::size_t>(pixels));
  for (std::size_t i = 0; i < normals.size(); ++i)
    view.normals[i / 3][static_cast<Eigen::Index>(i % 3)] = normals[i];
}

}  // namespace hermite::frame
