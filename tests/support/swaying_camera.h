// A small camera in a hand, and masks of what it sees.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"

namespace hermite::test {

inline constexpr shared::Intrinsics kCoarseCamera{65.6f, 65.6f, 39.5f, 29.5f, 80, 60};
inline constexpr std::size_t kCoarsePixels = 4800;

// world_from_camera of a hand's sway, by a centimetre and a third of a degree a frame.
inline Rigid3 swaying_pose(int frame) {
  return exp_se3(
      (Vector6d() << 0.012 * frame, -0.005 * frame, 0.004 * frame, 0, 0.006 * frame, 0).finished());
}

inline std::size_t count(const frame::CoarseMask& mask) {
  return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1u));
}

}  // namespace hermite::test
