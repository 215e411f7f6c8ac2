#include "core/texture/texture.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/output/mesh_check.h"
#include "core/texture/atlas.h"
#include "core/texture/texture_blend.h"
#include "core/texture/texture_detail.h"
#include "core/texture/texture_view.h"
#include "core/texture/view_alignment.h"
#include "core/texture/view_exposure.h"
#include "core/texture/view_selection.h"
#include "core/texture/view_warp.h"

namespace hermite::texture {

namespace {

// Amount of work between two checks whether to stop.
constexpr std::size_t kViewsAtOnce = 16, kChartsAtOnce = 64;
// Approximate shares of the time at which the steps end.
constexpr double kSelected = 0.15, kLoaded = 0.25, kAligned = 0.5, kCharted = 0.6;

const Error kTexturingStopped{ErrorCode::kBusy, "texturing was stopped"};

bool goes_on(const TextureProgress& progress, double share) { return !progress || progress(share); }

Status check(const output::TriangleMesh& mesh, const TextureFrames& frames,
             const TextureOptions& options) {
  for (const Status& status :
       {validate(options), validate(frames), output::check_mesh_with_triangles(mesh)})
    if (!status.ok()) return status;
  if (!mesh.pages.empty())
    return Error{ErrorCode::kInvalidArgument, "the mesh has a texture already"};
  return Done{};
}

Result<std::vector<TextureView>> loaded_views(const output::TriangleMesh& mesh,
                                              const TextureFrames& frames,
                                              const std::vector<std::size_t>& view_frames,
                                              const TextureOptions& options,
                                              const TextureProgress& progress) {
  std::vector<TextureView> views;
  for (std::size_t first = 0; first < view_frames.size(); first += kViewsAtOnce) {
    const std::size_t count = std::min(kViewsAtOnce, view_frames.size() - first);
    if (!goes_on(progress, kSelected + (kLoaded - kSelected) * static_cast<double>(first) /
                                           static_cast<double>(view_frames.size())))
      return kTexturingStopped;
    std::vector<std::optional<TextureView>> some(count);
    in_parallel(count, options.thread_count, [&](std::size_t i) {
      if (is_stopped(options)) return;
      if (Result<TextureView> view = load_view(mesh, frames, view_frames[first + i]); view.ok())
        some[i] = *std::move(view);
    });
    for (std::optional<TextureView>& view : some) {
      if (!view) continue;  // other frames show the same surface
      const auto sees = [](float inverse_depth) { return inverse_depth > 0; };
      if (!std::any_of(view->inverse_depth_per_m.pixels.begin(),
                       view->inverse_depth_per_m.pixels.end(), sees))
        continue;
      view->blur_px = static_cast<float>(blur_px(frames, view->frame));
      views.push_back(*std::move(view));
    }
  }
  if (is_stopped(options)) return kTexturingStopped;
  if (views.empty())
    return Error{ErrorCode::kNotFound,
                 "no frame has a pose, can be read and sees the mesh: there is no colour to take"};
  return views;
}

Status paint_pages(const Atlas& atlas, const TexelBlender& blender, const TextureOptions& options,
                   const TextureProgress& progress, output::TriangleMesh& result) {
  // Largest charts first; if they came last, one thread would work while the others wait.
  std::vector<std::size_t> order(atlas.charts.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto size = [&](std::size_t i) {
    return static_cast<std::size_t>(atlas.charts[i].width) *
           static_cast<std::size_t>(atlas.charts[i].height);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  double all = 0, done = 0;
  for (const std::size_t i : order) all += static_cast<double>(size(i));
  for (std::size_t first = 0; first < order.size(); first += kChartsAtOnce) {
    if (!goes_on(progress, kCharted + (1 - kCharted) * done / all)) return kTexturingStopped;
    const std::size_t count = std::min(kChartsAtOnce, order.size() - first);
    in_parallel(count, options.thread_count, [&](std::size_t k) {
      if (is_stopped(options)) return;
      const std::size_t i = order[first + k];
      const ColorImage image = blender.blended(atlas.charts[i]);
      ColorImage& page = result.pages[static_cast<std::size_t>(atlas.places[i].page)].image;
      for (int y = 0; y < image.height; ++y)
        std::copy_n(&image.at(0, y), image.width,
                    &page.at(atlas.places[i].x, atlas.places[i].y + y));
    });
    for (std::size_t k = 0; k < count; ++k) done += static_cast<double>(size(order[first + k]));
  }
  return Done{};
}

double filled_share(const Atlas& atlas) {
  double filled = 0, all = 0;
  for (const FlatChart& chart : atlas.charts)
    filled += static_cast<double>(chart.width) * chart.height;
  for (const RectangleSize& page : atlas.pages)
    all += static_cast<double>(page.width) * page.height;
  return all > 0 ? filled / all : 0;
}

}  // namespace

Result<std::vector<TextureView>> agreed_views(const output::TriangleMesh& mesh,
                                              const TextureFrames& frames,
                                              const std::vector<std::size_t>& view_frames,
                                              const TextureRun& run) {
  const auto& [options, progress, statistics] = run;
  Result<std::vector<TextureView>> views =
      loaded_views(mesh, frames, view_frames, options, progress);
  if (!views.ok()) return views;
  if (options.solves_exposure) solve_exposure(mesh, frames.camera, options, *views);
  if (!goes_on(progress, kLoaded)) return kTexturingStopped;
  Alignment alignment;
  if (options.refines_poses) {
    alignment = align_views(mesh, frames, options, *views);
    warp_views(mesh, frames, options, *views);
  }
  if (!goes_on(progress, kAligned)) return kTexturingStopped;
  statistics.views = views->size();
  statistics.moved_views = alignment.moved_count;
  statistics.disagreement_before = alignment.before_rms;
  statistics.disagreement_after = alignment.after_rms;
  return views;
}

Result<output::TriangleMesh> painted(const output::TriangleMesh& mesh, const Camera& camera,
                                     const std::vector<TextureView>& views, const TextureRun& run) {
  const auto& [options, progress, statistics] = run;
  const Result<Atlas> atlas =
      atlas_of(mesh, finest_pixels_m(mesh, camera, views, options), options);
  if (!atlas.ok()) return atlas.error();
  if (!goes_on(progress, kCharted)) return kTexturingStopped;
  output::TriangleMesh result = laid_out(mesh, *atlas);
  const TexelBlender blender(mesh, camera, views, {options.blended_views});
  if (Status done = paint_pages(*atlas, blender, options, progress, result); !done.ok())
    return done.error();
  if (is_stopped(options) || !goes_on(progress, 1)) return kTexturingStopped;
  statistics.charts = atlas->charts.size();
  statistics.texel_m = atlas->texel_m;
  statistics.filled_share = filled_share(*atlas);
  return result;
}

Result<output::TriangleMesh> textured(const output::TriangleMesh& mesh, const TextureFrames& frames,
                                      const TextureOptions& options,
                                      const TextureProgress& progress,
                                      TextureStatistics* statistics) {
  if (Status checked = check(mesh, frames, options); !checked.ok()) return checked.error();
  if (!goes_on(progress, 0)) return kTexturingStopped;
  TextureStatistics counted;
  const std::vector<std::size_t> selected = selected_views(mesh, frames, options);
  if (!goes_on(progress, kSelected)) return kTexturingStopped;
  const Result<std::vector<TextureView>> views =
      agreed_views(mesh, frames, selected, {options, progress, counted});
  if (!views.ok()) return views.error();
  Result<output::TriangleMesh> result =
      painted(mesh, frames.camera, *views, {options, progress, counted});
  if (statistics) *statistics = counted;
  return result;
}

}  // namespace hermite::texture
