// Wavefront OBJ: metres, y up (axes.h), vt with (0, 0) at the lower left corner, vn. Without a
// texture, v has a colour after the position, which MeshLab, Blender and others read and the rest
// ignore. Numbers read back as the same floats. Deterministic, pure.
#pragma once

#include "core/base/result.h"
#include "core/output/named_file.h"
#include "core/output/triangle_mesh.h"

namespace hermite::output {

// Returns mesh.obj, and with a texture also mesh.mtl and texture_0.jpg, texture_1.jpg, ... of the
// pages. Returns kInvalidArgument as check_mesh_with_triangles.
Result<NamedFiles> format_obj(const TriangleMesh& mesh);

}  // namespace hermite::output
