// Applies edits to a mesh or a cloud. Pure functions: the order of what stays is kept, and the
// result depends on nothing else.
#pragma once

#include <span>

#include "core/edit/scan_edits.h"
#include "core/output/cloud.h"
#include "core/output/triangle_mesh.h"

namespace hermite::edit {

// Points of a cloud that are nearer than this are connected; those that are four times as far apart
// are not, unless by others.
inline constexpr double kConnected_m = 0.05;

// Returns the cloud without the points that the edits take out. The parts of a cloud are its points
// that are connected; the largest part stays, however small it is. Points that are not finite
// belong to no part.
output::Cloud edited(output::Cloud cloud, std::span<const ScanEdit> edits);

// Triangles are cut along the faces of the boxes, so edges are straight. A new vertex has what lies
// between the two ends of its edge; triangles on both sides of an edge share it. The parts of a
// mesh are its triangles that share a vertex, or the place of one. Without triangles if nothing is
// left. The mesh is one that check_mesh accepts.
output::TriangleMesh edited(output::TriangleMesh mesh, std::span<const ScanEdit> edits);

}  // namespace hermite::edit
