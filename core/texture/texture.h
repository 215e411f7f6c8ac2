// The texture of a finished mesh, out of the frames of its recording.
//
//   TriangleMesh mesh = *textured(*contour(field, options), frames, TextureOptions());
//
// The sharpest frames become views; their exposure and poses are brought to agree on the surface, and what no pose explains is bent away;
// the mesh is cut into charts, with the finer texels the nearer it was seen, and each texel takes its colour from the few views that see it
// best.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/texture_options.h"
#include "core/texture/texture_view.h"

namespace hermite {

struct TextureStatistics {
  std::size_t views = 0, moved_views = 0, charts = 0;
  double texel_m = 0;
  double filled_share = 0;                                 // of the pages' texels, those of charts' rectangles
  double disagreement_before = 0, disagreement_after = 0;  // RMS of brightness off the views' mean, before and after poses were refined
};

// The same surface with texture coordinates and pages; vertices exist once for each chart, triangles are in another order. The same bytes
// for any number of threads. Memory: images and depths of the views (some 2.5 MB each of 640 x 480), the pages, and about 200 bytes a
// triangle. kInvalidArgument: options, frames or mesh are none (a vertex that is not finite, a triangle without its vertex, no triangle, a
// texture already); kNotFound: no frame has a pose, can be read and sees the mesh; kTooLarge: the surface does not fit the pages; kBusy:
// stopped.
Result<TriangleMesh> textured(const TriangleMesh& mesh, const TextureFrames& frames, const TextureOptions& options,
                              const TextureProgress& progress = {}, TextureStatistics* statistics = nullptr);

// The two halves of it, for what looks at the views in between. `statistics` is needed here.
// The views of these frames, which have poses, as they agree with each other.
Result<std::vector<TextureView>> agreed_views(const TriangleMesh& mesh, const TextureFrames& frames,
                                              const std::vector<std::size_t>& view_frames, const TextureOptions& options,
                                              const TextureProgress& progress, TextureStatistics& statistics);
// The mesh with their colours.
Result<TriangleMesh> painted(const TriangleMesh& mesh, const Camera& camera, const std::vector<TextureView>& views,
                             const TextureOptions& options, const TextureProgress& progress, TextureStatistics& statistics);

}  // namespace hermite
