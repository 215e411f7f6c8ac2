// Regions of coarse views.
//
// Pure functions on the host. Any thread.
#pragma once

#include <cstddef>

#include "core/frame/coarse_view.h"

namespace hermite::track {

// Returns from which distance on two depths are of different surfaces.
double clearly_m(double depth_m);

// Returns all pixels within `reach_px` of a pixel of the mask.
frame::CoarseMask grown(const frame::CoarseMask& mask, const frame::CoarseView& view, int reach_px);

// Transfers a mask of `view` to the neighbouring frame `other`.
frame::CoarseMask beside(const frame::CoarseMask& mask, const frame::CoarseView& view,
                         const frame::CoarseView& other);

// Returns the connected regions of `seeds`, extended by adjoining `candidates` on the same surface,
// that have at least `least_pixels`.
frame::CoarseMask regions(const frame::CoarseMask& seeds, const frame::CoarseMask& candidates,
                          const frame::CoarseView& view, std::size_t least_pixels);

// Returns the share of the view's pixels with a surface that belong to the mask, 0 to 1.
double share_of_surface(const frame::CoarseMask& mask, const frame::CoarseView& view);

}  // namespace hermite::track
