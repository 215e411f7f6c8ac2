// A mesh cut into charts: pieces that can be laid flat by looking at them along one direction. Pure functions, metres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite {

struct Chart {
  std::vector<std::uint32_t> triangles;  // in the order in which it grew
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
};

// Triangles on the other side of the three edges, in the order of the corners they start from; kNoNeighbour at a border of the mesh and
// where more than two triangles meet. `mesh` has fewer than 2^31 triangles.
inline constexpr std::uint32_t kNoNeighbour = 0xffffffff;
std::vector<std::array<std::uint32_t, 3>> neighbours_of(const TriangleMesh& mesh);

// Grows charts over neighbours for as long as
//   - the smoothed normal stays within 45 degrees of the chart's mean, and the triangle's own within 75: noise of the surface cuts nothing,
//   - the chart stays within a square of `max_side_m`, seen along its first normal; one triangle alone may be larger.
// Small charts are then given to large ones beside them that can see their triangles at no more than 75 degrees.
// Each triangle of `candidates` is in exactly one chart afterwards. Deterministic: grows from the lowest triangle left, breadth first.
class ChartGrower {
 public:
  ChartGrower(const TriangleMesh& mesh, double max_side_m);

  std::vector<Chart> grow(const std::vector<std::uint32_t>& candidates);

 private:
  struct Face {
    Eigen::Vector3f normal, smooth_normal;  // unit, or 0 where the triangle has no area
    float area_m2 = 0;
  };
  struct Frontier;
  bool fits(const Frontier& frontier, std::uint32_t triangle) const;
  Chart grow_from(std::uint32_t seed);
  void give_small_ones_away(std::vector<Chart>& charts);

  const TriangleMesh& mesh_;
  const float max_side_m_;
  const std::vector<std::array<std::uint32_t, 3>> neighbours_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> chart_of_;  // by triangle
};

}  // namespace hermite
