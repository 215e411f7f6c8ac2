// A loop of points in space filled with triangles between them, by dynamic programming (Liepa 2003, Filling holes in meshes, section 3;
// Barequet, Sharir 1995). Pure.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite {

// Of a polygon; longer ones are cut into polygons of so many points first.
inline constexpr std::size_t kMostPolygonPoints = 100;

struct LoopToFill {
  std::span<const Eigen::Vector3d> points_m;               // at least 3
  std::span<const Eigen::Vector3d> face_normals;           // by point, of the surface beyond the edge to the next: unit, or 0 where unknown
  std::function<bool(std::size_t, std::size_t)> is_taken;  // whether an edge between these two points is the surface's already
};

// points - 2 triangles of the loop's points and direction. Of all that do it those whose sharpest fold, with each other and the surface
// around, is the least; of those the smallest. None: edges that are taken are in the way. Time: cubic up to kMostPolygonPoints, then
// linear.
std::optional<std::vector<TriangleCorners>> triangulated(const LoopToFill& loop);

}  // namespace hermite
