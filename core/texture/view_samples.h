// Points all over a mesh, and which views see them: what gains and poses of the views are found from.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_view.h"

namespace hermite {

struct MeshSample {
  Eigen::Vector3f position_m, normal;
};

// Evenly by area, one for each `spacing_m` squared, fewer where that would be more than `max_count`. Deterministic.
std::vector<MeshSample> samples_of(const TriangleMesh& mesh, double spacing_m, std::size_t max_count);

// By view the numbers of the samples that it sees, ascending, at least `least_edge_px` from an edge.
std::vector<std::vector<std::uint32_t>> sights_of(const std::vector<MeshSample>& samples, const std::vector<TextureView>& views,
                                                  const Camera& camera, float least_edge_px, int thread_count);

}  // namespace hermite
