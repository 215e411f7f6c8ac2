// Meshes of squares, with some left out.
#pragma once

#include <functional>

#include "core/mesh/mesh_parts.h"
#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

// `side` x `side` squares of `cell_m` at height_m(x, y), seen from +z; those for which `is_open`
// says so are missing.
inline output::TriangleMesh grid_mesh(
    int side, float cell_m, const std::function<bool(int x, int y)>& is_open,
    const std::function<float(float x_m, float y_m)>& height_m = [](float, float) {
      return 0.0f;
    }) {
  output::TriangleMesh mesh;
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x) {
      const float x_m = cell_m * static_cast<float>(x), y_m = cell_m * static_cast<float>(y);
      mesh.positions_m.emplace_back(x_m, y_m, height_m(x_m, y_m));
      mesh.normals.emplace_back(Eigen::Vector3f::UnitZ());
      mesh.colors.push_back({100, 150, 200});
    }
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      if (is_open(x, y)) continue;
      const auto at = [&](int dx, int dy) {
        return static_cast<std::uint32_t>((y + dy) * (side + 1) + x + dx);
      };
      mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  remove_unused_vertices(mesh);
  return mesh;
}

// Without the squares from `first` to before `last`, both ways.
inline std::function<bool(int, int)> square_hole(int first, int last) {
  return [=](int x, int y) { return x >= first && x < last && y >= first && y < last; };
}

}  // namespace hermite::mesh
