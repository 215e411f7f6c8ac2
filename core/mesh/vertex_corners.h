// The triangle corners at each vertex. Corner 3 * t + k is vertex k of triangle t; its edge runs to
// the next corner of the triangle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

inline std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}
inline std::uint32_t previous_corner(std::uint32_t corner) {
  return corner % 3 == 0 ? corner + 2 : corner - 1;
}
inline std::uint32_t vertex_at(const output::TriangleMesh& mesh, std::uint32_t corner) {
  return mesh.triangles[corner / 3][corner % 3];
}

// The corners at each vertex of a mesh whose triangles are in range and do not change in the
// meantime. Uses four bytes per corner and per vertex. Const and thread-safe.
class VertexCorners {
 public:
  explicit VertexCorners(const output::TriangleMesh& mesh)
      : first_(mesh.positions_m.size() + 1), corners_(3 * mesh.triangles.size()) {
    for (const output::TriangleCorners& triangle : mesh.triangles)
      for (const std::uint32_t vertex : triangle) ++first_[vertex];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : first_) count = sum += count;
    for (auto corner = static_cast<std::uint32_t>(corners_.size()); corner-- > 0;)
      corners_[--first_[vertex_at(mesh, corner)]] = corner;
  }

  // Returns the corners at a vertex in ascending order.
  std::span<const std::uint32_t> at(std::uint32_t vertex) const {
    return std::span(corners_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::uint32_t> first_;  // by vertex, and one more
  std::vector<std::uint32_t> corners_;
};

}  // namespace hermite::mesh
