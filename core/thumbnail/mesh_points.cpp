#include "core/thumbnail/mesh_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace hermite::thumbnail {

namespace {

// Of one triangle: its corners, and how to colour a place in it.
struct Face {
  const output::TriangleMesh& mesh;
  const output::TriangleCorners& corners;
  const ColorImage* page;  // nullptr: no texture

  const Eigen::Vector3f& corner_m(std::size_t i) const { return mesh.positions_m[corners[i]]; }

  Rgb8 color(const Eigen::Vector3f& weights) const {
    if (page != nullptr && !page->pixels.empty()) {
      Eigen::Vector2f at = Eigen::Vector2f::Zero();
      for (std::size_t i = 0; i < 3; ++i)
        at += weights[static_cast<int>(i)] * mesh.texture_coordinates[corners[i]];
      // Beyond its borders a texture repeats.
      const auto pixel = [](float coordinate, int size) {
        const float inside = coordinate - std::floor(coordinate);
        return std::clamp(static_cast<int>(inside * static_cast<float>(size)), 0, size - 1);
      };
      return page->at(pixel(at.x(), page->width), pixel(at.y(), page->height));
    }
    Eigen::Vector3f mixed = Eigen::Vector3f::Constant(0.5f);
    for (std::size_t i = 0; i < 3; ++i) {
      const Rgb8& color = mesh.colors[corners[i]];
      mixed += weights[static_cast<int>(i)] * Eigen::Vector3f(color.r, color.g, color.b);
    }
    return {static_cast<std::uint8_t>(mixed.x()), static_cast<std::uint8_t>(mixed.y()),
            static_cast<std::uint8_t>(mixed.z())};
  }
};

float area_m2(const Face& face) {
  return (face.corner_m(1) - face.corner_m(0)).cross(face.corner_m(2) - face.corner_m(0)).norm() /
         2;
}

// The middles of n * n equal triangles that make up the face.
void add_points(const Face& face, float spacing_m, output::Cloud& cloud) {
  const Eigen::Vector3f cross =
      (face.corner_m(1) - face.corner_m(0)).cross(face.corner_m(2) - face.corner_m(0));
  const Eigen::Vector3f normal = cross.normalized();
  const int parts =
      std::max(1, static_cast<int>(std::lround(std::sqrt(cross.norm() / 2) / spacing_m)));
  // Of a long thin triangle the parts are as long and thin.
  float longest_m = 0;
  for (std::size_t i = 0; i < 3; ++i)
    longest_m = std::max(longest_m, (face.corner_m((i + 1) % 3) - face.corner_m(i)).norm());
  const float radius_m = longest_m / static_cast<float>(parts) * 0.6f;
  const auto add = [&](float u, float v) {
    const Eigen::Vector3f weights =
        Eigen::Vector3f(u, v, 3.0f * static_cast<float>(parts) - u - v) /
        (3.0f * static_cast<float>(parts));
    output::CloudPoint point;
    point.position_m = weights.x() * face.corner_m(0) + weights.y() * face.corner_m(1) +
                       weights.z() * face.corner_m(2);
    point.normal = normal;
    point.color = face.color(weights);
    point.radius_m = radius_m;
    cloud.push_back(point);
  };
  for (int i = 0; i < parts; ++i)
    for (int j = 0; i + j < parts; ++j) {
      const float u = static_cast<float>(3 * i), v = static_cast<float>(3 * j);
      add(u + 1, v + 1);
      if (i + j + 1 < parts) add(u + 2, v + 2);
    }
}

}  // namespace

output::Cloud points_on(const output::TriangleMesh& mesh, std::size_t most) {
  CHECK(most > 0, "no points were asked for");
  const std::size_t step = std::max<std::size_t>(1, (mesh.triangles.size() + most - 1) / most);
  std::size_t page = 0;
  const auto face_at = [&](std::size_t i) {
    while (page < mesh.pages.size() &&
           i >= std::size_t{mesh.pages[page].first_triangle} + mesh.pages[page].triangle_count)
      ++page;
    return Face{mesh, mesh.triangles[i],
                page < mesh.pages.size() ? &mesh.pages[page].image : nullptr};
  };
  double whole_m2 = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += step)
    whole_m2 += static_cast<double>(area_m2(face_at(i)));
  page = 0;
  output::Cloud cloud;
  if (!(whole_m2 > 0)) return cloud;
  const auto spacing_m = static_cast<float>(std::sqrt(whole_m2 / static_cast<double>(most)));
  for (std::size_t i = 0; i < mesh.triangles.size(); i += step) {
    const Face face = face_at(i);
    if (!(area_m2(face) > 0)) continue;
    const std::size_t first = cloud.size();
    add_points(face, spacing_m, cloud);
    for (std::size_t j = first; j < cloud.size(); ++j)
      cloud[j].radius_m *= std::sqrt(static_cast<float>(step));
  }
  return cloud;
}

}  // namespace hermite::thumbnail
