// A surface for distance queries: triangles of a mesh, or between the measurements of depth images
// at known poses.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite::evaluate {

using Triangle = std::array<Eigen::Vector3f, 3>;  // three equal corners are a point

double distance_to_triangle_m(const Eigen::Vector3f& point, const Triangle& triangle);

// Appends triangles between neighbouring measurements, every `step`-th pixel in x and y; none
// across more than 3 % of the depth, where another surface begins.
void append_depth_triangles(const DepthImage& depth, const Camera& camera,
                            const Rigid3& world_from_camera, int step,
                            std::vector<Triangle>& triangles);

// Const functions are thread-safe.
class TriangleSurface {
 public:
  // Distances are exact below `reach_m`, and `reach_m` beyond. Triangles that are not finite are
  // ignored.
  TriangleSurface(const std::vector<Triangle>& triangles, double reach_m);

  double distance_m(const Eigen::Vector3d& point) const;
  bool empty() const { return triangles_.empty(); }

 private:
  struct Range {
    std::uint32_t first = 0, last = 0;
  };
  Eigen::Vector3i cell_of(const Eigen::Vector3f& point) const;
  void insert(const Triangle& triangle, int depth);

  const double reach_m_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> by_cell_;
  std::unordered_map<std::uint64_t, Range> cells_;
};

}  // namespace hermite::evaluate
