// Refines the poses of views so that they agree on the colour of the surface (Zhou and Koltun,
// Color Map Optimization for 3D Reconstruction with Consumer Depth Cameras, SIGGRAPH 2014, section
// 4; the rigid part).
#pragma once

#include <cstddef>
#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite::texture {

// The largest correction of a pose; larger ones are rejected.
inline constexpr double kFarthestMove_m = 0.1, kFarthestTurn_rad = 0.06;

struct Alignment {
  std::size_t moved_count = 0;  // views whose pose was changed
  // RMS difference of a point's brightness from the mean of the other views, 0 to 255.
  double before_rms = 0, after_rms = 0;
};

// Alternates two steps, from coarse to fine: points of the surface get the mean brightness of the
// views that see them, then each view takes a Gauss-Newton step of its pose towards the points'
// brightness without its own contribution. The surface stays fixed. A view keeps its pose if the
// correction exceeds the limits above or does not reduce the differences. Renders the depth of the
// views again afterwards. Deterministic for any number of threads. The last `guest_count` views do
// not contribute to the points' brightness; if there are any, only they are moved. Uses
// thread_count and is_stopped of `options`.
Alignment align_views(const output::TriangleMesh& mesh, const TextureFrames& frames,
                      const TextureOptions& options, std::vector<TextureView>& views,
                      std::size_t guest_count = 0);

}  // namespace hermite::texture
