#include "core/texture/view_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace hermite::texture {

namespace {

// Returns two numbers of 0 to 1 that fill the square evenly (the R2 sequence of Roberts, by powers
// of the plastic number).
Eigen::Vector2f even_pair(std::uint64_t index) {
  const auto part = [index](double step) {
    const double value = 0.5 + step * static_cast<double>(index % 1'000'003);
    return static_cast<float>(value - std::floor(value));
  };
  return {part(0.7548776662466927), part(0.5698402909980532)};
}

}  // namespace

std::vector<MeshSample> samples_of(const output::TriangleMesh& mesh, double spacing_m,
                                   std::size_t max_count) {
  std::vector<double> areas_m2(mesh.triangles.size());
  double sum_m2 = 0;
  for (std::size_t i = 0; i < areas_m2.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    const Eigen::Vector3f ab = mesh.positions_m[b] - mesh.positions_m[a],
                          ac = mesh.positions_m[c] - mesh.positions_m[a];
    areas_m2[i] = 0.5 * static_cast<double>(ab.cross(ac).norm());
    sum_m2 += areas_m2[i];
  }
  const double step_m2 = std::max(
      spacing_m * spacing_m, sum_m2 / static_cast<double>(std::max<std::size_t>(max_count, 1)));
  std::vector<MeshSample> samples;
  double next_m2 = 0.5 * step_m2, passed_m2 = 0;
  for (std::size_t i = 0; i < areas_m2.size(); ++i) {
    passed_m2 += areas_m2[i];
    const auto& [a, b, c] = mesh.triangles[i];
    for (; next_m2 < passed_m2 && samples.size() < max_count; next_m2 += step_m2) {
      Eigen::Vector2f weights = even_pair(samples.size());
      if (weights.sum() > 1) weights = Eigen::Vector2f(1 - weights.x(), 1 - weights.y());
      const float first = 1 - weights.sum();
      const Eigen::Vector3f normal =
          first * mesh.normals[a] + weights.x() * mesh.normals[b] + weights.y() * mesh.normals[c];
      if (!(normal.norm() > 0)) continue;
      samples.push_back({first * mesh.positions_m[a] + weights.x() * mesh.positions_m[b] +
                             weights.y() * mesh.positions_m[c],
                         normal.normalized()});
    }
  }
  return samples;
}

std::vector<std::vector<std::uint32_t>> sights_of(const std::vector<MeshSample>& samples,
                                                  const std::vector<TextureView>& views,
                                                  const Camera& camera, float least_edge_px,
                                                  int thread_count) {
  std::vector<std::vector<std::uint32_t>> sights(views.size());
  in_parallel(views.size(), thread_count, [&](std::size_t i) {
    for (std::uint32_t k = 0; k < samples.size(); ++k)
      if (seen_at(views[i], camera, samples[k].position_m, samples[k].normal, least_edge_px))
        sights[i].push_back(k);
  });
  return sights;
}

}  // namespace hermite::texture
