// From corners that move to the pixels around them that do.
//
// Pure functions, host only, any thread.
#pragma once

#include <vector>

#include "core/frame/coarse_view.h"
#include "core/track/corner_tracks.h"
#include "core/track/own_motion.h"

namespace hermite {

// Pixels of `view`, cut into `surfaces`, that belong to corners that move rather than to those that rest. `image_width` is that of the
// image whose pixels the corners are given in.
CoarseMask regions_of_corners(const CoarseView& view, const ViewSurfaces& surfaces, const std::vector<SeenCorner>& corners,
                              int image_width);

}  // namespace hermite
