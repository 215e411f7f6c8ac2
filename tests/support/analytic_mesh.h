// Meshes given by formulas, for tests of what writes them. Header only.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "core/output/triangle_mesh.h"

namespace hermite::test {

// A sphere around (0.5, -0.25, 2), coloured by its normal: rings * segments quads, those at the
// poles with one side of no length.
inline output::TriangleMesh sphere_mesh(std::uint32_t rings, std::uint32_t segments,
                                        float radius_m = 0.5f) {
  output::TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t k = 0; k < segments; ++k) {
      const double polar = std::numbers::pi * i / rings,
                   around = 2 * std::numbers::pi * k / segments;
      const Eigen::Vector3f normal =
          Eigen::Vector3d(std::sin(polar) * std::cos(around), std::cos(polar),
                          std::sin(polar) * std::sin(around))
              .normalized()
              .cast<float>();
      const auto byte = [](float value) { return static_cast<std::uint8_t>(127.5f * (value + 1)); };
      mesh.positions_m.push_back(Eigen::Vector3f(0.5f, -0.25f, 2) + radius_m * normal);
      mesh.normals.push_back(normal);
      mesh.colors.push_back({byte(normal.x()), byte(normal.y()), byte(normal.z())});
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t k = 0; k < segments; ++k) {
      const std::uint32_t a = i * segments + k, b = i * segments + (k + 1) % segments,
                          c = b + segments, d = a + segments;
      if (i + 1 < rings) mesh.triangles.push_back({a, c, d});
      if (i > 0) mesh.triangles.push_back({a, b, c});
    }
  return mesh;
}

// The square from (0, 0, 1) to (1, 1, 1) that looks towards the origin, in columns of quads.
// `page_count` images, one after the other, of one colour each: (40 times its number, 80, 120).
// Every page has at least one column.
inline output::TriangleMesh textured_plane(std::uint32_t columns, std::uint32_t page_count,
                                           int image_edge_px) {
  output::TriangleMesh mesh;
  for (std::uint32_t page = 0; page < page_count; ++page) {
    output::TexturePage image{ColorImage(image_edge_px, image_edge_px),
                              static_cast<std::uint32_t>(mesh.triangles.size()), 0};
    for (Rgb8& pixel : image.image.pixels) pixel = {static_cast<std::uint8_t>(40 * page), 80, 120};
    for (std::uint32_t column = page; column < columns; column += page_count) {
      const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
      for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        mesh.positions_m.push_back({static_cast<float>(column + static_cast<std::uint32_t>(u)) /
                                        static_cast<float>(columns),
                                    static_cast<float>(v), 1});
        mesh.normals.push_back({0, 0, -1});
        mesh.colors.push_back({static_cast<std::uint8_t>(40 * page), 80, 120});
        mesh.texture_coordinates.push_back({static_cast<float>(u), static_cast<float>(v)});
      }
      mesh.triangles.push_back({first, first + 2, first + 1});
      mesh.triangles.push_back({first, first + 3, first + 2});
    }
    image.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size()) - image.first_triangle;
    mesh.pages.push_back(image);
  }
  return mesh;
}

// Out of the triangle, by the order of its corners: twice its area long.
inline Eigen::Vector3f face_normal(const output::TriangleMesh& mesh,
                                   const output::TriangleCorners& corners) {
  const Eigen::Vector3f& a = mesh.positions_m[corners[0]];
  return (mesh.positions_m[corners[1]] - a).cross(mesh.positions_m[corners[2]] - a);
}

}  // namespace hermite::test
