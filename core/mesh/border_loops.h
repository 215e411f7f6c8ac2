// The boundary loops of a mesh, and which of them surround a hole. Pure functions.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh/vertex_corners.h"
#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

// A boundary loop that passes through no vertex twice.
struct BorderLoop {
  // In the winding order of a triangle that fills the loop; at least 3.
  std::vector<std::uint32_t> vertices;
  // By vertex, normal of the triangle at the edge to the next: unit, or 0 without an area.
  std::vector<Eigen::Vector3f> face_normals;
};

struct Borders {
  std::vector<BorderLoop> loops;  // each starts at its lowest vertex index; sorted by that index
  // Loops that touch themselves or each other, or whose triangles are not oriented alike.
  std::size_t tangled = 0;
};

Borders borders_of(const output::TriangleMesh& mesh, const VertexCorners& corners);

// Returns whether any two vertices of the loop are farther apart than this.
bool is_wider(const output::TriangleMesh& mesh, const BorderLoop& loop, double width_m);

// Returns whether the loop surrounds a hole rather than enclosing a piece of surface: seen along
// the surface normal, the two wind in opposite directions. The open end of a tube, where normals
// point in all directions, is not a hole.
bool is_hole(const output::TriangleMesh& mesh, const BorderLoop& loop);

}  // namespace hermite::mesh
