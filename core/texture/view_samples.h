// Points sampled over a mesh, and which views see them; gains and poses of the views are estimated
// from these.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite::texture {

struct MeshSample {
  Eigen::Vector3f position_m, normal;
};

// Returns samples that are uniform by area, one per `spacing_m` squared, or fewer if that would
// exceed `max_count`. Deterministic.
std::vector<MeshSample> samples_of(const output::TriangleMesh& mesh, double spacing_m,
                                   std::size_t max_count);

// Returns, by view, the ascending indices of the samples that it sees at least `least_edge_px` from
// an edge.
std::vector<std::vector<std::uint32_t>> sights_of(const std::vector<MeshSample>& samples,
                                                  const std::vector<TextureView>& views,
                                                  const Camera& camera, float least_edge_px,
                                                  int thread_count);

}  // namespace hermite::texture
