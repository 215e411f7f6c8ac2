// Surfels that the first cleaning takes away again, so that a map has many slots which nobody is
// in. Header only.
#pragma once

#include "core/output/cloud.h"

namespace hermite::test {

// Surfels in view of the first camera, behind all walls, and curved beyond what is believed. For
// Pipeline::insert().
inline output::Cloud doomed_surfels(std::size_t count) {
  output::Cloud doomed(count);
  for (std::size_t i = 0; i < count; ++i) {
    doomed[i].position_m = {0.0001f * static_cast<float>(i % 500),
                            0.0001f * static_cast<float>(i / 500), 9};
    doomed[i].normal = -Eigen::Vector3f::UnitZ();
    doomed[i].confidence = 9;
    doomed[i].radius_m = 0.02f;
    doomed[i].curvature_max_per_m = 1000;
  }
  return doomed;
}

}  // namespace hermite::test
