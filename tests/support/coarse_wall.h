// What a small camera sees of a wall across its axis. Header only.
#pragma once

#include <cstddef>
#include <vector>

#include "core/frame/coarse_view.h"

namespace hermite::test {

inline constexpr shared::Intrinsics kCoarseCamera{65.6f, 65.6f, 39.5f, 29.5f, 80, 60};
inline constexpr std::size_t kCoarsePixels = 4800;

inline frame::CoarseView coarse_wall(double depth_m) {
  return {kCoarseCamera, std::vector<float>(kCoarsePixels, static_cast<float>(depth_m)),
          std::vector<Eigen::Vector3f>(kCoarsePixels, Eigen::Vector3f::UnitZ()),
          std::vector<float>(kCoarsePixels, 100)};
}

}  // namespace hermite::test
