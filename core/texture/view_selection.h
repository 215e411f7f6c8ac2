// Selects the frames from which a texture takes colour: sharp ones from different viewpoints that
// cover the surface.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/texture_options.h"

namespace hermite::texture {

// Returns the variance of the Laplacian of the green channel over the whole image; it is larger for
// the sharper of two images of a scene.
double laplacian_variance(const ColorImage& image);

// Returns how far the image centre moves during one frame at a depth of 2 m [px], from the poses of
// the adjacent frames.
double blur_px(const TextureFrames& frames, std::size_t frame);

// Returns frames in order of time. A new window begins whenever the camera has moved by
// options.view_step_m or turned by options.view_turn_deg; of the slowest frames of each window the
// sharpest is taken. Of two that are closer than that to each other, also if they are far apart in
// time, one is kept. If more than options.max_views remain, they are selected greedily by how much
// they add to the coverage of the surface; parts that no selected view sees count most.
std::vector<std::size_t> selected_views(const output::TriangleMesh& mesh,
                                        const TextureFrames& frames, const TextureOptions& options);

}  // namespace hermite::texture
