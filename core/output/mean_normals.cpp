#include "core/output/mean_normals.h"

#include <Eigen/Geometry>

namespace hermite::output {

std::vector<Eigen::Vector3f> mean_normals(const std::vector<Eigen::Vector3f>& positions,
                                          const std::vector<TriangleCorners>& triangles) {
  std::vector<Eigen::Vector3f> normals(positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3f& corner = positions[a];
    const Eigen::Vector3f twice_area = (positions[b] - corner).cross(positions[c] - corner);
    for (const std::uint32_t vertex : {a, b, c}) normals[vertex] += twice_area;
  }
  for (Eigen::Vector3f& normal : normals) normal.stableNormalize();
  return normals;
}

}  // namespace hermite::output
