// Divides a mesh into charts: pieces that can be flattened by projection along one direction. Pure
// functions, metres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite::texture {

struct Chart {
  std::vector<std::uint32_t> triangles;  // in the order in which they were added
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
};

// Stands for the triangle across an edge that has none.
inline constexpr std::uint32_t kNoNeighbour = 0xffffffff;

// Returns, for each triangle, the triangles across its three edges, in the order of the corners at
// which the edges start; kNoNeighbour at a boundary and at an edge of more than two triangles.
// `mesh` has fewer than 2^31 triangles.
std::vector<std::array<std::uint32_t, 3>> neighbours_of(const output::TriangleMesh& mesh);

// Grows charts over adjacent triangles while
//   - the smoothed normal stays within 45 degrees of the chart's mean, and the triangle's own
//     within 75: noise ends no chart,
//   - the chart stays within a square of `max_side_m`, projected along its first normal; a single
//     triangle may be larger.
// Small charts are then merged into adjacent large ones whose normals are within 75 degrees of
// their triangles. Each triangle of `candidates` is then in exactly one chart. Deterministic: grows
// breadth first from the lowest triangle that is left.
class ChartGrower {
 public:
  ChartGrower(const output::TriangleMesh& mesh, double max_side_m);

  std::vector<Chart> grow(const std::vector<std::uint32_t>& candidates);

 private:
  struct Face {
    Eigen::Vector3f normal, smooth_normal;  // unit, or 0 if the triangle has no area
    float area_m2 = 0;
  };
  struct Frontier;
  bool fits(const Frontier& frontier, std::uint32_t triangle) const;
  Chart grow_from(std::uint32_t seed);
  void give_small_ones_away(std::vector<Chart>& charts);

  const output::TriangleMesh& mesh_;
  const float max_side_m_;
  const std::vector<std::array<std::uint32_t, 3>> neighbours_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> chart_of_;  // by triangle
};

}  // namespace hermite::texture
