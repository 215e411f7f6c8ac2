// What every writer of a mesh relies on. Pure.
#pragma once

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// Indices are 32 bits in every format, and PLY's readers take them for signed.
inline constexpr std::size_t kMaxMeshVertices = 0x7fffffff;

// kInvalidArgument, naming the vertex, triangle or page: arrays by vertex of different lengths, a position, normal or texture coordinate
// that is not finite, a triangle without its vertex, marks of another number than triangles, pages that do not follow each other or leave
// triangles out, a page whose image is none. kTooLarge: more than kMaxMeshVertices. A mesh without a triangle is one.
Status check_mesh(const TriangleMesh& mesh);

// The same, and kInvalidArgument for a mesh without a triangle: for formats that cannot say nothing.
Status check_mesh_with_triangles(const TriangleMesh& mesh);

}  // namespace hermite
