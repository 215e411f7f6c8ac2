// Regions of coarse views, and what they are of the whole frame.
//
// Pure functions on the host. Any thread.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "core/frame/coarse_view.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

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

bool has_any(const frame::CoarseMask& mask);

// Returns whether a pixel of the whole image of `camera` belongs to the mask of `view`.
bool is_in(const frame::CoarseMask& mask, const frame::CoarseView& view,
           const Eigen::Vector2d& pixel, const Camera& camera);

// Returns the frame without depth in the mask of its coarse view; nullopt if the mask has no
// pixels.
std::optional<frame::RgbdFrame> without_depth_in(const frame::CoarseMask& mask,
                                                 const frame::CoarseView& view,
                                                 const frame::RgbdFrame& frame);

// Returns the share of the view's pixels with a surface that belong to the mask, 0 to 1.
double share_of_surface(const frame::CoarseMask& mask, const frame::CoarseView& view);

}  // namespace hermite::track
