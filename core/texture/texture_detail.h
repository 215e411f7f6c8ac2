// How finely the views have seen a mesh: how large a texel there should be. Pure, thread-safe.
#pragma once

#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite {

// Of a vertex that no view sees.
inline constexpr float kNeverSeen_m = 1e9f;

// By vertex what one pixel covers there at its longer side [m], in the view where that is least. The same for any number of threads.
// Of `options` those of work: thread_count and is_stopped.
std::vector<float> finest_pixels_m(const TriangleMesh& mesh, const Camera& camera, const std::vector<TextureView>& views,
                                   const TextureOptions& options);

}  // namespace hermite
