// Binary STL: only triangles, z up (axes.h). Millimetres, because the format has no unit and
// slicers assume them. Pure.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite::output {

// Normals are those of the triangles, or zero for one without area. Returns kInvalidArgument as
// check_mesh_with_triangles, and kTooLarge when the number of triangles exceeds 32 bits.
Result<std::string> format_stl(const TriangleMesh& mesh);

}  // namespace hermite::output
