// What no pose explains: views bent a little so that they agree on the colour of the surface (Zhou and Koltun, Color Map Optimization for
// 3D Reconstruction with Consumer Depth Cameras, SIGGRAPH 2014, section 5). Depth that is wrong by a percent in the corners, a colour
// camera that is not quite where it is said to be and rows that were taken one after the other shift near things against far ones by some
// pixels, and a texture of several views shows them twice.
#pragma once

#include <cstddef>
#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite {

// No point of an image goes farther.
inline constexpr float kFarthestWarp_px = 12;

// Gives the views their warps, by turns: points of the surface get the mean brightness of the views that see them, and each view takes a
// Gauss-Newton step of its lattice towards the points' brightness without its own share. Lattices are held together by springs and at 0 by
// weaker ones: where there is nothing to see a view stays as it is. Images of half the size first. Deterministic for any number of threads.
// The last `guest_count` views have no say in the points' brightness; with any, only they are warped.
// Of `options` those of work: thread_count and is_stopped.
void warp_views(const TriangleMesh& mesh, const TextureFrames& frames, const TextureOptions& options, std::vector<TextureView>& views,
                std::size_t guest_count = 0);

}  // namespace hermite
