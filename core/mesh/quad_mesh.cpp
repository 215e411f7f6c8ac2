#include "core/mesh/quad_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/check.h"
#include "core/mesh/mesh_parts.h"

namespace hermite::mesh {
namespace {

template <class Item, class KeyOf>
std::uint32_t index_by(VertexKey key, const std::vector<Item>& items, KeyOf key_of) {
  const auto found = std::ranges::lower_bound(items, key, {}, key_of);
  CHECK(found != items.end() && std::invoke(key_of, *found) == key,
        "two cubes differ about what lies between them");
  return static_cast<std::uint32_t>(found - items.begin());
}

}  // namespace

void QuadMesh::add_vertices(const std::vector<CubeVertex>& vertices) {
  for (const CubeVertex& vertex : vertices) {
    mesh_.positions_m.push_back(vertex.position_m);
    mesh_.normals.push_back(vertex.normal);
    mesh_.colors.push_back(vertex.color);
    is_smooth_.push_back(vertex.is_smooth);
    is_supported_.push_back(vertex.is_supported);
  }
}

// Returns how well a triangle fits the normals at its corners; corners on sharp edges are ignored.
float QuadMesh::fit(const output::TriangleCorners& triangle) const {
  const auto& p = mesh_.positions_m;
  const Eigen::Vector3f across =
      (p[triangle[1]] - p[triangle[0]]).cross(p[triangle[2]] - p[triangle[0]]);
  const float length = across.norm();
  if (!(length > 0)) return -1;  // degenerate
  float least = 1;
  for (const std::uint32_t vertex : triangle)
    if (is_smooth_[vertex]) least = std::min(least, across.dot(mesh_.normals[vertex]) / length);
  return least;
}

void QuadMesh::add(const std::array<std::uint32_t, 4>& v) {
  for (const std::uint32_t vertex : v)
    if (!is_supported_[vertex]) return;
  const std::array<output::TriangleCorners, 2> one = {{{v[0], v[1], v[2]}, {v[0], v[2], v[3]}}},
                                               other = {{{v[0], v[1], v[3]}, {v[1], v[2], v[3]}}};
  const float fit_of_one = std::min(fit(one[0]), fit(one[1])),
              fit_of_other = std::min(fit(other[0]), fit(other[1]));
  const auto diagonal2 = [this](std::uint32_t a, std::uint32_t b) {
    return (mesh_.positions_m[a] - mesh_.positions_m[b]).squaredNorm();
  };
  constexpr float kAlike = 0.01f;
  const bool takes_one = std::abs(fit_of_one - fit_of_other) > kAlike
                             ? fit_of_one > fit_of_other
                             : diagonal2(v[0], v[2]) <= diagonal2(v[1], v[3]);
  for (const output::TriangleCorners& triangle : takes_one ? one : other)
    mesh_.triangles.push_back(triangle);
}

std::uint32_t index_of(VertexKey key, const std::vector<CubeVertex>& vertices) {
  return index_by(key, vertices, &CubeVertex::key);
}
std::uint32_t index_of(VertexKey key, const std::vector<VertexKey>& keys) {
  return index_by(key, keys, std::identity());
}

output::TriangleMesh mesh_of(const CubeSurface& surface) {
  QuadMesh quads;
  quads.add_vertices(surface.vertices);
  for (const CubeQuad& quad : surface.quads) {
    std::array<std::uint32_t, 4> corners{};
    std::transform(quad.begin(), quad.end(), corners.begin(),
                   [&](VertexKey key) { return index_of(key, surface.vertices); });
    quads.add(corners);
  }
  output::TriangleMesh mesh = quads.take();
  mesh.confidence_eighths.reserve(surface.vertices.size());
  for (const CubeVertex& vertex : surface.vertices)
    mesh.confidence_eighths.push_back(vertex.confidence_eighths);
  remove_unused_vertices(mesh);
  return mesh;
}

}  // namespace hermite::mesh
