// The small camera of coarse_wall.h in a hand, and masks of what it sees. Header only.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"
#include "tests/support/coarse_wall.h"

namespace hermite::test {

// world_from_camera of a hand's sway, by a centimetre and a third of a degree a frame.
inline Rigid3 swaying_pose(int frame) {
  return exp_se3(
      (Vector6d() << 0.012 * frame, -0.005 * frame, 0.004 * frame, 0, 0.006 * frame, 0).finished());
}

inline std::size_t count(const frame::CoarseMask& mask) {
  return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1u));
}

}  // namespace hermite::test
