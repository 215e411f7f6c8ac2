// A mesh as binary little-endian PLY: x y z nx ny nz (float) red green blue (uchar), and faces as
// lists of three (uchar, int vertex_indices), with filled (uchar, 1: interpolated across a hole) if
// the mesh has marks. Metres, in the world frame of the scan, like cloud.ply and trajectory.txt.
// Textures are not written. Pure.
#pragma once

#include <string>

#include "core/output/triangle_mesh.h"

namespace hermite::output {

// Writes the mesh, which may be empty. A CHECK fails unless there are as many normals and colours
// as positions, marks for all triangles or none, and at most kMaxMeshVertices.
std::string format_mesh_ply(const TriangleMesh& mesh);

}  // namespace hermite::output
