// Regions of coarse views.
//
// Pure functions on the host. Any thread.
#pragma once

#include <cstddef>

#include "core/frame/coarse_view.h"

namespace hermite {

// Returns from which distance on two depths are of different surfaces.
double clearly_m(double depth_m);

// Returns all pixels within `reach_px` of a pixel of the mask.
CoarseMask grown(const CoarseMask& mask, const CoarseView& view, int reach_px);

// Transfers a mask of `view` to the neighbouring frame `other`.
CoarseMask beside(const CoarseMask& mask, const CoarseView& view, const CoarseView& other);

// Returns the connected regions of `seeds`, extended by adjoining `candidates` on the same surface, that have at least
// `least_pixels`.
CoarseMask regions(const CoarseMask& seeds, const CoarseMask& candidates, const CoarseView& view, std::size_t least_pixels);

// Returns the share of the view's pixels with a surface that belong to the mask, 0 to 1.
double share_of_surface(const CoarseMask& mask, const CoarseView& view);

}  // namespace hermite
