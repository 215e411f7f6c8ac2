// Which corners rest and which move on their own between two frames. One rigid motion often fits both nearly: a camera that turns behind
// somebody who walks ahead sees almost what one sees that goes round him. So several parts of the corners are asked for a motion, and the
// one that explains most surface to the precision of following wins; the room has more surface than who walks through it.
//
// Pure functions, host only, any thread.
#pragma once

#include <optional>
#include <vector>

#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/track/feature_motion.h"

namespace hermite {

struct CornerSplit {
  Rigid3 earlier_from_frame;        // of what rests
  double deviation_px = 0;          // of the image, of what rests
  std::vector<double> error_px;     // by corner, of the image: where the frame shows it beside where it would be if it rested
  std::vector<std::uint8_t> moves;  // by corner
  double moving_share = 0;          // of the corners, by surface
};

// Corners with their depth. `moved_before`, by corner, may be empty; `precision_px` is how well corners are followed, a standard deviation
// in pixels of the image. Nothing: too few corners, or no motion explains half of their surface.
std::optional<CornerSplit> split_corners(const std::vector<FollowedCorner>& corners, const std::vector<std::uint8_t>& moved_before,
                                         const Camera& camera, double precision_px);

}  // namespace hermite
