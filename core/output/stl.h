// Binary STL: triangles alone, z up (axes.h). Millimetres, since the format has no unit and what prints takes it for those. Pure.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// Normals are those of the triangles; of one without an area, zero. kInvalidArgument: check_mesh_with_triangles. kTooLarge: more triangles
// than 32 bits count.
Result<std::string> format_stl(const TriangleMesh& mesh);

}  // namespace hermite
