// Views of a recording, points of the surface that they see, and the brightness on which the views
// agree at these points; from these, poses (view_alignment.h) and warps (view_warp.h) of the views
// are estimated.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/parallel.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"
#include "core/texture/view_brightness.h"
#include "core/texture/view_samples.h"

namespace hermite::texture {

// The density of surface samples: one point per spacing_m squared, at most max_count. A view sees a
// point only if it is at least edge_px from an edge of the surface.
struct SampleDensity {
  double spacing_m = 0.01;
  std::size_t max_count = 0;
  float edge_px = 0;
};

// The last guest_count views do not contribute to the brightness of the points; if there are any,
// only they are changed.
struct AdjustedViews {
  std::vector<TextureView>& views;
  std::size_t guest_count = 0;
};

// Holds references to its arguments. Deterministic for any number of threads. Not thread-safe,
// except for others_say().
struct SampledViews {
  SampledViews(const output::TriangleMesh& mesh, const Camera& of_views, const TextureOptions& how,
               const AdjustedViews& adjusted, const SampleDensity& density);

  // Sets `looks` by look(view, sample), views in parallel, and computes from those of all views but
  // guests the brightness of the points.
  template <class LookAt>
  void find_points(const LookAt& look) {
    looks.resize(views.size());
    in_parallel(views.size(), options.thread_count, [&](std::size_t i) {
      looks[i].resize(sights[i].size());
      for (std::size_t k = 0; k < sights[i].size(); ++k) looks[i][k] = look(i, sights[i][k]);
    });
    add_looks();
  }

  // Calls step(view) for each view that is to be changed, in parallel.
  template <class Step>
  void for_each_moving(const Step& step) const {
    in_parallel(views.size() - first_moving, options.thread_count,
                [&](std::size_t i) { step(first_moving + i); });
  }

  // Returns the brightness, in the other views, of the k-th point that a view sees; std::nullopt if
  // no other view sees it.
  std::optional<float> others_say(std::size_t view, std::size_t k) const;

  const Camera& camera;
  const TextureOptions& options;
  std::vector<TextureView>& views;
  const std::size_t first_guest, first_moving;
  const std::vector<MeshSample> samples;
  const std::array<BrightnessLevel, kBrightnessLevels> levels;
  // By view, indices of the samples that it sees.
  const std::vector<std::vector<std::uint32_t>> sights;
  std::vector<std::vector<Look>> looks;  // by view, for each of its sights
  std::vector<PointMean> points;         // by sample

 private:
  void add_looks();
};

}  // namespace hermite::texture
