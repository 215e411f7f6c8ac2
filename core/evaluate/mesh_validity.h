// Counts defects of a mesh that do not depend on what it shows; all counts are 0 for a valid mesh.
// Pure functions.
#pragma once

#include <cstdint>

#include "core/output/triangle_mesh.h"

namespace hermite::evaluate {

struct MeshValidity {
  std::int64_t vertices = 0, triangles = 0;
  std::int64_t not_finite_vertices = 0;
  // Triangles with the index of a missing vertex; ignored in all other counts.
  std::int64_t wrong_indices = 0;
  // Two corners are the same, or the area is less than a thousandth of a square millimetre.
  std::int64_t degenerate_faces = 0;
  std::int64_t repeated_faces = 0;  // another face has the same three corners
  std::int64_t overfull_edges = 0;  // edges with more than two faces
  std::int64_t border_edges = 0;    // edges with one face
  // Edges that both faces traverse in the same direction, so one face is seen from its back.
  std::int64_t disagreeing_edges = 0;
  // Faces whose normal points against the mean of their corners' normals; 0 without normals.
  std::int64_t flipped_faces = 0;
  std::int64_t pinched_vertices = 0;  // their faces form more than one fan
  std::int64_t loose_vertices = 0;    // in no face
  std::int64_t components = 0;        // parts that share no vertex
  double largest_component = 0;       // share of the triangles
  double area_m2 = 0;
};

MeshValidity mesh_validity(const output::TriangleMesh& mesh);

// Returns the number of vertices with none of the points within `within_m`.
std::int64_t vertices_away_from(const std::vector<Eigen::Vector3f>& points,
                                const output::TriangleMesh& mesh, double within_m);

}  // namespace hermite::evaluate
