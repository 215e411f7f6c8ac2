// The resolution at which the views have seen a mesh, which decides the texel size. Pure,
// thread-safe.
#pragma once

#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite::texture {

// The value of a vertex that no view sees.
inline constexpr float kNeverSeen_m = 1e9f;

// Returns, by vertex, the longer side of a pixel's footprint on the surface [m], in the view where
// it is smallest. Deterministic. Uses thread_count and is_stopped of `options`.
std::vector<float> finest_pixels_m(const output::TriangleMesh& mesh, const Camera& camera,
                                   const std::vector<TextureView>& views,
                                   const TextureOptions& options);

}  // namespace hermite::texture
