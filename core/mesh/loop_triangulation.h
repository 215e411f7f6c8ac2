// Triangulates a closed loop of points in space by dynamic programming (Liepa 2003, Filling holes
// in meshes, section 3; Barequet, Sharir 1995). Pure.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

// The most points for one run of dynamic programming; longer loops are first cut into polygons of
// this size.
inline constexpr std::size_t kMostPolygonPoints = 100;

struct LoopToFill {
  std::span<const Eigen::Vector3d> points_m;  // at least 3
  // By point, normal of the triangle across the edge to the next point: unit, or 0 where unknown.
  std::span<const Eigen::Vector3d> face_normals;
  // Whether the surface already has an edge between these two points.
  std::function<bool(std::size_t, std::size_t)> is_taken;
};

// Returns points - 2 triangles in the loop's winding order: of all triangulations one whose
// sharpest fold, including those against the surface around, is least; among equal ones the one of
// least area. Returns std::nullopt if existing edges prevent it. Takes cubic time up to
// kMostPolygonPoints, linear beyond.
std::optional<std::vector<output::TriangleCorners>> triangulated(const LoopToFill& loop);

}  // namespace hermite::mesh
