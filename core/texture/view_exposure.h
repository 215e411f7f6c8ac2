// Estimates the relative exposure and white balance of the views.
#pragma once

#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite::texture {

// Estimates the gains of the views (TextureView::gain) from points of the mesh that at least two of
// them see. By channel, the logarithm of a point's linear light in a view is modelled as the log
// gain of the view plus the log light of the point; solved by least squares, reweighted so that
// reflections and moving objects have little influence. The mean logarithm is 0. A view without
// common points keeps 1; gains are limited to 1/4 to 4. When stopped by options.is_stopped the
// gains stay as they were. Deterministic for any number of threads. Uses thread_count and
// is_stopped of `options`.
void solve_exposure(const output::TriangleMesh& mesh, const Camera& camera,
                    const TextureOptions& options, std::vector<TextureView>& views);

}  // namespace hermite::texture
