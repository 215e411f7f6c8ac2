// Computes image regions that move from corners that move.
//
// Pure functions on the host. Any thread.
#pragma once

#include <vector>

#include "core/frame/coarse_view.h"
#include "core/track/corner_tracks.h"
#include "core/track/own_motion.h"

namespace hermite::track {

// Returns the pixels of `view`, segmented into `surfaces`, that belong to moving corners rather
// than to resting ones. `image_width` is the width of the image in whose pixels the corners are
// given.
frame::CoarseMask regions_of_corners(const frame::CoarseView& view, const ViewSurfaces& surfaces,
                                     const std::vector<SeenCorner>& corners, int image_width);

}  // namespace hermite::track
