// Makes the texture of a finished mesh from the frames of its recording.
//
//   TriangleMesh mesh = *textured(*contour(field, options), frames, TextureOptions());
//
// The sharpest frames become views. Their exposures and poses are adjusted until they agree on the
// surface; remaining differences are removed by warping the images. The mesh is divided into
// charts, with finer texels where it was seen from nearer, and each texel takes its colour from the
// few views that see it best.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/texture_options.h"
#include "core/texture/texture_view.h"

namespace hermite::texture {

struct TextureStatistics {
  std::size_t views = 0, moved_views = 0, charts = 0;
  double texel_m = 0;
  double filled_share = 0;  // the fraction of the pages' texels in rectangles of charts
  // RMS difference of brightness from the views' mean, before and after refining the poses.
  double disagreement_before = 0, disagreement_after = 0;
};

// Returns the same surface with texture coordinates and pages; vertices are duplicated for each
// chart, and triangles are reordered. The result does not depend on the number of threads. Memory:
// images and depths of the views (about 2.5 MB for each of 640 x 480), the pages, and about 200
// bytes per triangle. kInvalidArgument for options, frames, and a mesh with a vertex that is not
// finite, a triangle whose vertex is missing, no triangle or a texture; kNotFound when no frame
// with a pose can be read and sees the mesh; kTooLarge when it does not fit the pages; kBusy when
// stopped.
Result<output::TriangleMesh> textured(const output::TriangleMesh& mesh, const TextureFrames& frames,
                                      const TextureOptions& options,
                                      const TextureProgress& progress = {},
                                      TextureStatistics* statistics = nullptr);

// How a mesh is textured, who is told how far that is, and what is counted. All must outlive it.
struct TextureRun {
  const TextureOptions& options;
  const TextureProgress& progress;
  TextureStatistics& statistics;
};

// The two halves of textured(), for callers that use the views in between.
//
// Returns the views of these frames, which must have poses, after adjusting exposures, poses and
// warps.
Result<std::vector<TextureView>> agreed_views(const output::TriangleMesh& mesh,
                                              const TextureFrames& frames,
                                              const std::vector<std::size_t>& view_frames,
                                              const TextureRun& run);
// Returns the mesh with a texture from these views.
Result<output::TriangleMesh> painted(const output::TriangleMesh& mesh, const Camera& camera,
                                     const std::vector<TextureView>& views, const TextureRun& run);

}  // namespace hermite::texture
