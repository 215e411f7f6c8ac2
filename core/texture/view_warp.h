// Non-rigid image alignment: views are warped slightly so that they agree on the colour of the
// surface (Zhou and Koltun, Color Map Optimization for 3D Reconstruction with Consumer Depth
// Cameras, SIGGRAPH 2014, section 5). Depth errors of a percent in the corners, an inexact pose of
// the colour camera, and a rolling shutter shift near objects relative to far ones by some pixels,
// which no pose corrects; a texture blended from several views would show them twice.
#pragma once

#include <cstddef>
#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite::texture {

// The largest offset of a node.
inline constexpr float kFarthestWarp_px = 12;

// Sets the warps of the views by alternating two steps: points of the surface get the mean
// brightness of the views that see them, then each view takes a Gauss-Newton step of its lattice
// towards the points' brightness without its own contribution. Springs between adjacent nodes, and
// weaker ones to 0, regularise the lattice where the image has no texture. Half-size images come
// first. Deterministic for any number of threads. The last `guest_count` views do not contribute to
// the points' brightness; if there are any, only they are warped. Uses thread_count and is_stopped
// of `options`.
void warp_views(const output::TriangleMesh& mesh, const TextureFrames& frames,
                const TextureOptions& options, std::vector<TextureView>& views,
                std::size_t guest_count = 0);

}  // namespace hermite::texture
