// The inner points of a patch moved to where the surface around asks for them. Pure.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/patch_refinement.h"

namespace hermite {

// What lies around a patch: triangles that have a point of its border.
struct PatchSurroundings {
  std::vector<Eigen::Vector3d> points_m;   // behind those of the patch, in numbers
  std::vector<TriangleCorners> triangles;  // of points of the patch and of these
};

// The way of least bending (bi-Laplacian with cotangent weights; Botsch et al. 2010, Polygon mesh processing, section 4.3): it goes on as
// the surface around does. False, and nothing moves: no solution.
bool bend_least(Patch& patch, const PatchSurroundings& around);

// By point, values that are the mean of those around them (Laplacian with cotangent weights), from those of the border: `border` has a row
// a point of it. Empty: no solution.
Eigen::MatrixXd spread_from_border(const Patch& patch, const Eigen::MatrixXd& border);

}  // namespace hermite
