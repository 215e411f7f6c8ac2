// What a small camera sees of a wall across its axis. Header only.
#pragma once

#include <vector>

#include "core/frame/coarse_view.h"

namespace hermite::test {

inline constexpr shared::Intrinsics kCoarseCamera{65.6f, 65.6f, 39.5f, 29.5f, 80, 60};

inline frame::CoarseView coarse_wall(double depth_m) {
  constexpr std::size_t kPixels = 4800;
  return {kCoarseCamera, std::vector<float>(kPixels, static_cast<float>(depth_m)),
          std::vector<Eigen::Vector3f>(kPixels, Eigen::Vector3f::UnitZ()),
          std::vector<float>(kPixels, 100)};
}

}  // namespace hermite::test
