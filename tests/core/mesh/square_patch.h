// A hole to fill.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/mesh/patch_refinement.h"

namespace hermite::mesh {

// A square of 8 x 8 edges of 1, as a fan.
inline Patch square_patch() {
  Patch patch;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < 8; ++i) {
      const double along = i, full = 8;
      patch.points_m.push_back(side == 0   ? Eigen::Vector3d(along, 0, 0)
                               : side == 1 ? Eigen::Vector3d(full, along, 0)
                               : side == 2 ? Eigen::Vector3d(full - along, full, 0)
                                           : Eigen::Vector3d(0, full - along, 0));
    }
  patch.border_count = patch.points_m.size();
  for (std::uint32_t i = 1; i + 1 < patch.border_count; ++i)
    patch.triangles.push_back({0, i, i + 1});
  return patch;
}

}  // namespace hermite::mesh
