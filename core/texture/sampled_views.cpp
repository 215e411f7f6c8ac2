#include "core/texture/sampled_views.h"

namespace hermite::texture {

SampledViews::SampledViews(const output::TriangleMesh& mesh, const Camera& of_views,
                           const TextureOptions& how, const AdjustedViews& adjusted,
                           const SampleDensity& density)
    : camera(of_views),
      options(how),
      views(adjusted.views),
      first_guest(views.size() - adjusted.guest_count),
      first_moving(adjusted.guest_count > 0 ? first_guest : 0),
      samples(samples_of(mesh, density.spacing_m, density.max_count)),
      levels(brightness_levels(views, options.thread_count)),
      sights(sights_of(samples, views, camera, density.edge_px, options.thread_count)) {}

// Adds one view after the other, so that the sums do not depend on the number of threads.
void SampledViews::add_looks() {
  points.assign(samples.size(), {});
  for (std::size_t i = 0; i < first_guest; ++i)
    for (std::size_t k = 0; k < sights[i].size(); ++k) {
      PointMean& mean = points[sights[i][k]];
      mean.weight += static_cast<double>(looks[i][k].weight);
      mean.sum += static_cast<double>(looks[i][k].weight) * static_cast<double>(looks[i][k].value);
    }
}

std::optional<float> SampledViews::others_say(std::size_t view, std::size_t k) const {
  const Look& own = looks[view][k];
  if (own.weight <= 0) return std::nullopt;
  return points[sights[view][k]].without(view < first_guest ? own : Look());
}

}  // namespace hermite::texture
