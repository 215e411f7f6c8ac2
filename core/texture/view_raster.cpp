#include "core/texture/view_raster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace hermite::texture {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

struct ScreenCorner {
  double u = 0, v = 0, inverse_depth_per_m = 0;
};

class Painter {
 public:
  Painter(const Camera& camera, ViewRaster& raster) : camera_(camera), raster_(raster) {}

  // `corners` are in the camera frame.
  void draw(const std::array<Vector3f, 3>& corners, std::uint32_t triangle) {
    const auto is_before = [](const Vector3f& corner) {
      return static_cast<double>(corner.z()) >= kNearestDrawn_m;
    };
    const int before = static_cast<int>(std::count_if(corners.begin(), corners.end(), is_before));
    if (before == 0) return;
    if (before == 3)
      return fill({on_screen(corners[0]), on_screen(corners[1]), on_screen(corners[2])}, triangle);
    std::array<ScreenCorner, 4> cut;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3f &from = corners[i], &to = corners[(i + 1) % 3];
      if (is_before(from)) cut[count++] = on_screen(from);
      if (is_before(from) != is_before(to)) {
        const float share = (static_cast<float>(kNearestDrawn_m) - from.z()) / (to.z() - from.z());
        cut[count++] = on_screen(from + share * (to - from));
      }
    }
    for (std::size_t i = 2; i < count; ++i) fill({cut[0], cut[i - 1], cut[i]}, triangle);
  }

 private:
  ScreenCorner on_screen(const Vector3f& corner) const {
    const Vector3d point = corner.cast<double>();
    const double z = std::max(point.z(), 0.5 * kNearestDrawn_m);
    return {camera_.fx * point.x() / z + camera_.cx, camera_.fy * point.y() / z + camera_.cy,
            1 / z};
  }

  void fill(const std::array<ScreenCorner, 3>& c, std::uint32_t triangle) {
    const double area =
        (c[1].u - c[0].u) * (c[2].v - c[0].v) - (c[2].u - c[0].u) * (c[1].v - c[0].v);
    if (!(std::abs(area) > 1e-12)) return;
    const auto first = [](double low) {
      return static_cast<int>(std::ceil(std::clamp(low, 0.0, 1e6)));
    };
    const auto last = [](double high, int side) {
      return static_cast<int>(std::floor(std::clamp(high, -1.0, side - 1.0)));
    };
    const int left = first(std::min({c[0].u, c[1].u, c[2].u})),
              right = last(std::max({c[0].u, c[1].u, c[2].u}), camera_.width);
    const int top = first(std::min({c[0].v, c[1].v, c[2].v})),
              bottom = last(std::max({c[0].v, c[1].v, c[2].v}), camera_.height);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        const double w1 =
            ((x - c[0].u) * (c[2].v - c[0].v) - (c[2].u - c[0].u) * (y - c[0].v)) / area;
        const double w2 =
            ((c[1].u - c[0].u) * (y - c[0].v) - (x - c[0].u) * (c[1].v - c[0].v)) / area;
        if (w1 < 0 || w2 < 0 || w1 + w2 > 1) continue;
        const auto inverse_depth =
            static_cast<float>((1 - w1 - w2) * c[0].inverse_depth_per_m +
                               w1 * c[1].inverse_depth_per_m + w2 * c[2].inverse_depth_per_m);
        const std::size_t at = raster_.triangle.index(x, y);
        if (inverse_depth <= raster_.inverse_depth_per_m.pixels[at]) continue;
        raster_.inverse_depth_per_m.pixels[at] = inverse_depth;
        raster_.triangle.pixels[at] = triangle;
      }
  }

  const Camera& camera_;
  ViewRaster& raster_;
};

}  // namespace

ViewRaster rasterised(const output::TriangleMesh& mesh, const Camera& camera,
                      const Rigid3& world_from_camera) {
  ViewRaster raster{Image<float>(camera.width, camera.height),
                    Image<std::uint32_t>(camera.width, camera.height)};
  std::fill(raster.triangle.pixels.begin(), raster.triangle.pixels.end(), kNoTriangle);
  const Rigid3 camera_from_world = inverse(world_from_camera);
  const Eigen::Matrix3f rotation = camera_from_world.rotation.toRotationMatrix().cast<float>();
  const Vector3f translation = camera_from_world.translation.cast<float>();
  std::vector<Vector3f> in_camera(mesh.positions_m.size());
  for (std::size_t i = 0; i < in_camera.size(); ++i)
    in_camera[i] = rotation * mesh.positions_m[i] + translation;
  // Planes through the camera centre and the borders of the image: a triangle entirely beyond one
  // of them is not visible.
  const auto left = static_cast<float>((-1 - camera.cx) / camera.fx),
             right = static_cast<float>((camera.width - camera.cx) / camera.fx);
  const auto top = static_cast<float>((-1 - camera.cy) / camera.fy),
             bottom = static_cast<float>((camera.height - camera.cy) / camera.fy);
  Painter painter(camera, raster);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const output::TriangleCorners& t = mesh.triangles[i];
    const std::array<Vector3f, 3> c{in_camera[t[0]], in_camera[t[1]], in_camera[t[2]]};
    const auto all = [&c](const auto& is_beyond) {
      return is_beyond(c[0]) && is_beyond(c[1]) && is_beyond(c[2]);
    };
    if (all([&](const Vector3f& p) { return p.x() < left * p.z(); }) ||
        all([&](const Vector3f& p) { return p.x() > right * p.z(); }) ||
        all([&](const Vector3f& p) { return p.y() < top * p.z(); }) ||
        all([&](const Vector3f& p) { return p.y() > bottom * p.z(); }))
      continue;
    if (c[0].allFinite() && c[1].allFinite() && c[2].allFinite()) painter.draw(c, i);
  }
  return raster;
}

Image<std::uint8_t> distance_from_edges_px(const Image<float>& inverse_depth_per_m) {
  const int width = inverse_depth_per_m.width, height = inverse_depth_per_m.height;
  Image<std::uint8_t> distance(width, height);
  const auto is_edge = [&](int x, int y) {
    const float here = inverse_depth_per_m.at(x, y);
    if (here <= 0 || x == 0 || y == 0 || x == width - 1 || y == height - 1) return true;
    const float l = inverse_depth_per_m.at(x - 1, y), r = inverse_depth_per_m.at(x + 1, y);
    const float t = inverse_depth_per_m.at(x, y - 1), b = inverse_depth_per_m.at(x, y + 1);
    if (l <= 0 || r <= 0 || t <= 0 || b <= 0) return true;
    return std::abs(l - 2 * here + r) > kEdgeBend * here ||
           std::abs(t - 2 * here + b) > kEdgeBend * here;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      distance.at(x, y) =
          is_edge(x, y) ? std::uint8_t{0} : static_cast<std::uint8_t>(kFarFromEdge_px);
  // Steps along rows, columns and diagonals, in two passes: within a tenth of the true distance
  // near the edges, where it matters.
  const auto lower = [&](int x, int y, int from_x, int from_y) {
    if (from_x < 0 || from_x >= width || from_y < 0 || from_y >= height) return;
    const int further = distance.at(from_x, from_y) + 1;
    if (further < distance.at(x, y)) distance.at(x, y) = static_cast<std::uint8_t>(further);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const auto& [dx, dy] :
           {std::array{-1, 0}, std::array{-1, -1}, std::array{0, -1}, std::array{1, -1}})
        lower(x, y, x + dx, y + dy);
  for (int y = height - 1; y >= 0; --y)
    for (int x = width - 1; x >= 0; --x)
      for (const auto& [dx, dy] :
           {std::array{1, 0}, std::array{1, 1}, std::array{0, 1}, std::array{-1, 1}})
        lower(x, y, x + dx, y + dy);
  return distance;
}

Vector3f weights_in_triangle(const output::TriangleMesh& mesh, std::uint32_t triangle,
                             const Rigid3& camera_from_world, const Vector3d& ray_in_camera) {
  std::array<Vector3d, 3> corners;
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] = camera_from_world * mesh.positions_m[mesh.triangles[triangle][i]].cast<double>();
  // Weights are volumes spanned by the ray and the sides.
  const Vector3d weights(ray_in_camera.dot(corners[1].cross(corners[2])),
                         ray_in_camera.dot(corners[2].cross(corners[0])),
                         ray_in_camera.dot(corners[0].cross(corners[1])));
  const double sum = weights.sum();
  if (!(std::abs(sum) > 0)) return Vector3f::Constant(1.0f / 3);
  return (weights / sum).cwiseMax(0.0).cwiseMin(1.0).cast<float>();
}

}  // namespace hermite::texture
