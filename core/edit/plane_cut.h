// Cuts the triangles of a mesh along planes, and takes triangles out. Textures, marks and the order
// of triangles are kept. Pure.
#pragma once

#include <functional>

#include "core/output/triangle_mesh.h"

namespace hermite::edit {

// Afterwards no triangle has corners on both sides of the plane normal . x = at_m. The normal has
// unit length. Vertices within a tenth of a millimetre of the plane count as in it.
void cut_by_plane(output::TriangleMesh& mesh, const Eigen::Vector3d& normal, double at_m);

// Keeps the triangles for which `is_kept` returns true, the vertices that they use, and the texture
// pages that have triangles left.
void keep_triangles(output::TriangleMesh& mesh,
                    const std::function<bool(const output::TriangleCorners& triangle)>& is_kept);

}  // namespace hermite::edit
