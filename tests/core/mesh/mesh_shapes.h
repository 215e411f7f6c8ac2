// Clouds of shapes whose surface is known, as scans would give them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "core/output/cloud.h"

namespace hermite::mesh {

inline output::CloudPoint surfel_at(const Eigen::Vector3f& position_m,
                                    const Eigen::Vector3f& normal) {
  output::CloudPoint point;
  point.position_m = position_m;
  point.normal = normal;
  point.color = {200, 100, 50};
  point.confidence = 5;
  return point;
}

// A square of the plane z = `z_m` around the origin, seen from +z.
inline void append_square(output::Cloud& cloud, float side_m, float spacing_m, float z_m = 0) {
  const int half = static_cast<int>(std::lround(0.5f * side_m / spacing_m));
  for (int y = -half; y <= half; ++y)
    for (int x = -half; x <= half; ++x)
      cloud.push_back(
          surfel_at({static_cast<float>(x) * spacing_m, static_cast<float>(y) * spacing_m, z_m},
                    Eigen::Vector3f::UnitZ()));
}

// Spread evenly, by the golden angle.
inline output::Cloud sphere(float radius_m, int count,
                            const Eigen::Vector3f& middle_m = Eigen::Vector3f::Zero()) {
  output::Cloud cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, turn = i * std::numbers::pi * (3 - std::sqrt(5.0)),
                 r = std::sqrt(1 - z * z);
    const Eigen::Vector3f normal(static_cast<float>(r * std::cos(turn)),
                                 static_cast<float>(r * std::sin(turn)), static_cast<float>(z));
    cloud.push_back(surfel_at(middle_m + radius_m * normal, normal));
  }
  return cloud;
}

// The surface of a cube around the origin, seen from outside, up to half a spacing from its edges.
inline output::Cloud cube(float side_m, float spacing_m) {
  output::Cloud cloud;
  const int count = static_cast<int>(std::lround(side_m / spacing_m));
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-0.5f, 0.5f})
      for (int b = 0; b < count; ++b)
        for (int c = 0; c < count; ++c) {
          Eigen::Vector3f position_m;
          position_m[axis] = side * side_m;
          position_m[(axis + 1) % 3] = (static_cast<float>(b) + 0.5f) * spacing_m - 0.5f * side_m;
          position_m[(axis + 2) % 3] = (static_cast<float>(c) + 0.5f) * spacing_m - 0.5f * side_m;
          Eigen::Vector3f normal = Eigen::Vector3f::Zero();
          normal[axis] = side > 0 ? 1.0f : -1.0f;
          cloud.push_back(surfel_at(position_m, normal));
        }
  return cloud;
}

}  // namespace hermite::mesh
