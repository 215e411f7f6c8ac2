// Cleaning of triangle meshes without a texture: small components, unused vertices, folds,
// non-manifold vertices and edges. Pure functions; the order of what stays is kept.
#pragma once

#include <cstddef>

#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

double area_m2(const output::TriangleMesh& mesh, const output::TriangleCorners& triangle);

// Removes connected components (by shared vertices) of less area than this. Returns how many.
std::size_t remove_small_parts(output::TriangleMesh& mesh, double least_part_m2);

// Removes vertices that no triangle uses; of a mesh with a texture, too.
void remove_unused_vertices(output::TriangleMesh& mesh);

// A triangle that faces against the mean normal of its corners is a fold, caused by noise or a
// narrow corner. The corners of folds are smoothed a few times, and triangles that are still folded
// are removed. Returns how many were removed.
std::size_t unfold(output::TriangleMesh& mesh);

// Makes the mesh manifold: afterwards the triangles around each vertex are one fan, and no edge has
// more than two. A vertex where several fans touch is duplicated for each; an edge of more than two
// triangles is opened. Returns how many vertices were added.
std::size_t split_touching_fans(output::TriangleMesh& mesh);

}  // namespace hermite::mesh
