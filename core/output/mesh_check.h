// The preconditions of every mesh writer. Pure.
#pragma once

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite::output {

// Indices are 32 bits in every format, and PLY readers interpret them as signed.
inline constexpr std::size_t kMaxMeshVertices = 0x7fffffff;

// Returns kInvalidArgument, naming the vertex, triangle or page, when per-vertex arrays differ in
// length, a position, normal or texture coordinate is not finite, a triangle refers to a missing
// vertex, the number of filled marks is not that of triangles, pages are not consecutive or do not
// cover all triangles, or the image of a page is invalid; kTooLarge above kMaxMeshVertices. A mesh
// without triangles is valid.
Status check_mesh(const TriangleMesh& mesh);

// The same, and kInvalidArgument for a mesh without triangles, for formats that cannot represent
// it.
Status check_mesh_with_triangles(const TriangleMesh& mesh);

}  // namespace hermite::output
