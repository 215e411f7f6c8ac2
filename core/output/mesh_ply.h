// A mesh as binary little-endian PLY: x y z nx ny nz (float) red green blue (uchar), and faces as lists of three (uchar, int
// vertex_indices), with filled (uchar, 1: made up across a hole) where the mesh has marks. Metres, in the world of the scan as it is,
// beside its cloud.ply and trajectory.txt. A texture is left out. Pure.
#pragma once

#include <string>

#include "core/output/triangle_mesh.h"

namespace hermite {

// A mesh without vertices or triangles is a file too. CHECK: as many normals and colours as positions, marks for all triangles or none, at
// most kMaxMeshVertices.
std::string format_mesh_ply(const TriangleMesh& mesh);

}  // namespace hermite
