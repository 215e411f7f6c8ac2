// Poses of views refined so that they agree on the colour of the surface (Zhou and Koltun, Color Map Optimization for 3D Reconstruction
// with Consumer Depth Cameras, SIGGRAPH 2014, section 4; the rigid part).
#pragma once

#include <cstddef>
#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite {

// How far a pose may go: what is farther off than that was not wrong by a little.
inline constexpr double kFarthestMove_m = 0.1, kFarthestTurn_rad = 0.06;

struct Alignment {
  std::size_t moved_count = 0;           // views that were given another pose
  double before_rms = 0, after_rms = 0;  // brightness of points in the views off the mean of their other views, 0 to 255
};

// Takes turns: points of the surface get the mean brightness of the views that see them, and each view takes a Gauss-Newton step of its six
// numbers towards the points' brightness without its own share; first on images of a quarter of the size. The surface stays. A view keeps
// its pose where the new one is farther than the above or does not explain the points better. Sees the mesh anew from the new poses.
// Deterministic for any number of threads.
// The last `guest_count` views have no say in the points' brightness; with any, only they move.
// Of `options` those of work: thread_count and is_stopped.
Alignment align_views(const TriangleMesh& mesh, const TextureFrames& frames, const TextureOptions& options, std::vector<TextureView>& views,
                      std::size_t guest_count = 0);

}  // namespace hermite
