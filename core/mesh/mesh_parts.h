// Order in a mesh of triangles: what is connected, what is too small, where sheets touch that are not one. Without a texture. Pure
// functions; the order of what stays is kept.
#pragma once

#include <cstddef>

#include "core/output/triangle_mesh.h"

namespace hermite {

double area_m2(const TriangleMesh& mesh, const TriangleCorners& triangle);

// Leaves out pieces, connected by vertices, whose surface is less than that. Returns how many.
std::size_t remove_small_parts(TriangleMesh& mesh, double least_part_m2);

// Vertices that no triangle has go.
void remove_unused_vertices(TriangleMesh& mesh);

// Triangles that look against the mean normal of their corners are folds, which noise and narrow corners make: their corners move to the
// middle of their neighbours, a few times, and what is folded still is left out. Returns how many triangles were.
std::size_t unfold(TriangleMesh& mesh);

// After this, triangles around each vertex are one fan, and no edge has more than two: a vertex where fans touch is there once for each,
// and an edge that more than two triangles share is open. Returns how many vertices were added.
std::size_t split_touching_fans(TriangleMesh& mesh);

}  // namespace hermite
