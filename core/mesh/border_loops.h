// Where a mesh ends: its borders, and which of them go round a hole. Pure functions.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh/vertex_corners.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// A border that passes no vertex twice.
struct BorderLoop {
  std::vector<std::uint32_t> vertices;        // in the order in which a triangle that fills it has them; at least 3
  std::vector<Eigen::Vector3f> face_normals;  // by vertex, of the triangle at the edge to the next one: unit, or 0 without an area
};

struct Borders {
  std::vector<BorderLoop> loops;  // each from its lowest vertex on, in the order of those
  std::size_t tangled = 0;        // others: they touch themselves or each other, or triangles there do not agree which side is outside
};

Borders borders_of(const TriangleMesh& mesh, const VertexCorners& corners);

// Whether two of the loop's vertices are farther apart than that.
bool is_wider(const TriangleMesh& mesh, const BorderLoop& loop, double width_m);

// A hole has the surface around it, where a piece of surface ends its border has it within: seen along the surface's normal the two run
// round the other way. The end of a tube, where normals point everywhere, is no hole.
bool is_hole(const TriangleMesh& mesh, const BorderLoop& loop);

}  // namespace hermite
