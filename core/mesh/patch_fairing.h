// Moves the inner points of a patch so that it continues the surface around it (fairing). Pure.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/patch_refinement.h"

namespace hermite::mesh {

// The surroundings of a patch: triangles that have a vertex on its boundary.
struct PatchSurroundings {
  std::vector<Eigen::Vector3d> points_m;           // indexed after those of the patch
  std::vector<output::TriangleCorners> triangles;  // of points of the patch and of these
};

// Minimises bending (bi-Laplacian with cotangent weights; Botsch et al. 2010, Polygon mesh
// processing, section 4.3), so that the patch continues the curvature around it. Returns false, and
// moves nothing, if the system has no solution.
bool bend_least(Patch& patch, const PatchSurroundings& around);

// Interpolates values of the boundary to all points (Laplacian with cotangent weights). `border`
// has one row per boundary point, the result one per point; it is empty if there is no solution.
Eigen::MatrixXd spread_from_border(const Patch& patch, const Eigen::MatrixXd& border);

}  // namespace hermite::mesh
