// Wavefront OBJ: metres, y up (axes.h), v with colours behind the position where there is no texture (which MeshLab, Blender and others
// read, and the rest skip), vt with (0, 0) in the lower left corner, vn. Numbers read back as the same floats. Deterministic, pure.
#pragma once

#include "core/base/result.h"
#include "core/output/named_file.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// mesh.obj; with a texture also mesh.mtl and texture_0.jpg, texture_1.jpg, ... of the pages. kInvalidArgument: check_mesh_with_triangles.
Result<NamedFiles> format_obj(const TriangleMesh& mesh);

}  // namespace hermite
