// Triangles across a hole become about as small as those around it, and evenly shaped (Liepa 2003, Filling holes in meshes, section 4).
// Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite {

// A disc of triangles. The first `border_count` points are its border and stay.
struct Patch {
  std::vector<Eigen::Vector3d> points_m;
  std::vector<TriangleCorners> triangles;
  std::size_t border_count = 0;
};

// Adds points within it and turns edges. Edges grow from the border inwards, so that a large patch takes few points. `is_taken`: of two
// points of the border, whether an edge between them is the surface's already; none such is made.
void refine(Patch& patch, const std::function<bool(std::size_t, std::size_t)>& is_taken);

}  // namespace hermite
