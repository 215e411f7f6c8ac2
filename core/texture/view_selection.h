// Which frames a texture takes colour from: sharp ones, no two of almost the same view, spread over the surface.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/texture_options.h"

namespace hermite {

// Variance of the Laplacian of the green channel over the whole image: of images of one scene the sharper has more.
double laplacian_variance(const ColorImage& image);

// By which way a pixel in the middle of the image moves in a frame, from the poses of the neighbours at 2 m [px].
double blur_px(const TextureFrames& frames, std::size_t frame);

// In order of time. Wherever the camera has moved by options.view_step_m or turned by options.view_turn_deg a new window begins; the
// slowest frames of each are read and the sharpest is taken. Of two that are nearer than that to each other, later laps included, one
// stays. Of more than options.max_views those are kept one after the other that add most to what is seen of the surface, what nobody has
// seen before counting most.
std::vector<std::size_t> selected_views(const TriangleMesh& mesh, const TextureFrames& frames, const TextureOptions& options);

}  // namespace hermite
