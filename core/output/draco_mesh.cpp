#include "core/output/draco_mesh.h"

namespace hermite::output {

void set_triangles(draco::Mesh& mesh, std::size_t vertex_count,
                   const std::vector<TriangleCorners>& triangles) {
  mesh.set_num_points(static_cast<std::uint32_t>(vertex_count));
  mesh.SetNumFaces(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    draco::Mesh::Face face;
    for (std::size_t k = 0; k < 3; ++k) face[k] = draco::PointIndex(triangles[i][k]);
    mesh.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(i)), face);
  }
}

}  // namespace hermite::output
