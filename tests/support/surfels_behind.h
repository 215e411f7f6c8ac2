// Surfels that take room and nothing else. Header only.
#pragma once

#include "core/output/cloud.h"

namespace hermite::test {

// Stable ones behind the first camera, where it never looks. For Pipeline::insert().
inline output::Cloud surfels_behind(std::size_t count) {
  output::Cloud cloud(count);
  for (std::size_t i = 0; i < count; ++i) {
    cloud[i].position_m = {0.01f * static_cast<float>(i % 300), 0.01f * static_cast<float>(i / 300),
                           -9};
    cloud[i].normal = Eigen::Vector3f::UnitZ();
    cloud[i].confidence = 9;
    cloud[i].radius_m = 0.02f;
  }
  return cloud;
}

}  // namespace hermite::test
