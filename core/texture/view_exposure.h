// Exposure and white balance of the views against each other.
#pragma once

#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite {

// Finds the gains of the views (TextureView::gain) from the points of the mesh that two and more of them see: by channel the logarithm of a
// point's linear light in a view is that of the view's gain and that of the point added up; least squares, reweighted so that reflections
// and what moved count little. The mean logarithm is 0. A view that shares nothing with others keeps 1, and none is farther than a factor
// of 4 from 1. Stopped by options.is_stopped it leaves the gains as they were. Deterministic for any number of threads.
// Of `options` those of work: thread_count and is_stopped.
void solve_exposure(const TriangleMesh& mesh, const Camera& camera, const TextureOptions& options, std::vector<TextureView>& views);

}  // namespace hermite
