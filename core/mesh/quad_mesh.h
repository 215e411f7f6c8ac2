// Splits the quads of dual contouring into triangles along the diagonal that fits the normals
// better. Unsupported quads are left out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/contour_cube.h"
#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

class QuadMesh {
 public:
  void add_vertices(const std::vector<CubeVertex>& vertices);
  std::uint32_t vertex_count() const {
    return static_cast<std::uint32_t>(mesh_.positions_m.size());
  }
  // Indices of vertices that were added before.
  void add(const std::array<std::uint32_t, 4>& corners);
  output::TriangleMesh take() { return std::move(mesh_); }

 private:
  float fit(const output::TriangleCorners& triangle) const;

  std::vector<bool> is_smooth_, is_supported_;  // by vertex
  output::TriangleMesh mesh_;
};

// Returns the mesh of a surface with all of its vertices (contour_whole_cube), without unused
// vertices.
output::TriangleMesh mesh_of(const CubeSurface& surface);

// Return the index of the key in vertices or keys that are sorted by key. CHECK: it is there.
std::uint32_t index_of(VertexKey key, const std::vector<CubeVertex>& vertices);
std::uint32_t index_of(VertexKey key, const std::vector<VertexKey>& keys);

}  // namespace hermite::mesh
