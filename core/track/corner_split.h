// Separates corners that rest from corners that move on their own between two frames. One rigid
// motion often nearly fits both: a camera that turns behind a person who walks ahead sees almost
// the same as one that moves around the person. So a motion is fitted to each of several subsets of
// the corners, and the one that explains most surface to the precision of corner tracking wins; a
// room has more surface than a person who walks through it.
//
// Pure functions on the host. Any thread.
#pragma once

#include <optional>
#include <vector>

#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/track/feature_motion.h"

namespace hermite::track {

struct CornerSplit {
  Rigid3 earlier_from_frame;  // motion of the camera relative to the resting corners
  double deviation_px = 0;    // of the resting corners, image pixels
  // By corner, image pixels: distance between its measured position and where it would be if it
  // rested.
  std::vector<double> error_px;
  std::vector<std::uint8_t> moves;  // by corner
  double moving_share = 0;          // share of the corners that move, weighted by surface area
};

// Separates corners whose depth is known. `moved_before`, by corner, may be empty; `precision_px`
// is the standard deviation of corner tracking in image pixels. Returns std::nullopt if there are
// too few corners, or if no motion explains half of their surface.
std::optional<CornerSplit> split_corners(const std::vector<FollowedCorner>& corners,
                                         const std::vector<std::uint8_t>& moved_before,
                                         const Camera& camera, double precision_px);

}  // namespace hermite::track
