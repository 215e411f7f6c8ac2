// Refines the triangulation of a hole to the triangle size around it, with evenly shaped triangles
// (Liepa 2003, Filling holes in meshes, section 4). Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

// A triangulated disc. The first `border_count` points are its boundary and stay fixed.
struct Patch {
  std::vector<Eigen::Vector3d> points_m;
  std::vector<output::TriangleCorners> triangles;
  std::size_t border_count = 0;
};

// Inserts points and flips edges. Edge lengths grow from the boundary inwards, so that a large
// patch needs few points. `is_taken` returns whether the surface already has an edge between two
// boundary points; such an edge is not made again.
void refine(Patch& patch, const std::function<bool(std::size_t, std::size_t)>& is_taken);

}  // namespace hermite::mesh
