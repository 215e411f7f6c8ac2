// Quads of dual contouring become triangles, on the diagonal that goes better with the normals. What is not supported is left out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/contour_cube.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

class QuadMesh {
 public:
  void add_vertices(const std::vector<CubeVertex>& vertices);
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(mesh_.positions_m.size()); }
  void add(const std::array<std::uint32_t, 4>& corners);  // numbers of vertices that were added
  TriangleMesh take() { return std::move(mesh_); }

 private:
  float fit(const TriangleCorners& triangle) const;

  std::vector<bool> is_smooth_, is_supported_;  // by vertex
  TriangleMesh mesh_;
};

// Of a surface with all its vertices (contour_whole_cube), those that no triangle has left out.
TriangleMesh mesh_of(const CubeSurface& surface);

// The place of that key in vertices in the order of their keys, or in the keys alone; CHECK: it is there.
std::uint32_t index_of(VertexKey key, const std::vector<CubeVertex>& vertices);
std::uint32_t index_of(VertexKey key, const std::vector<VertexKey>& keys);

}  // namespace hermite
