// From submaps, keyframes and landmarks to a bundle problem, and its solution back into them.
#pragma once

#include <vector>

#include "core/adjust/bundle.h"
#include "core/adjust/sparse_map.h"
#include "core/adjust/submap_graph.h"

namespace hermite {

// Which of the map's things a problem holds: indices of the map, in the order of the problem.
struct BundleScope {
  struct Sighting {
    std::uint32_t landmark = 0;
    Observation observation;
  };
  std::vector<std::uint32_t> submaps, landmarks;
  std::vector<Sighting> sightings;
};

struct BundleOfMap {
  BundleScope scope;
  BundleProblem problem;
};

// Links between the submaps only: a pose graph. The submap `fixed` stays. Loops are taken at their word, so that the map comes to where
// they say, however far it is; whether the other links can bear that is for the caller to see.
BundleOfMap pose_graph_of(const SparseMap& map, const SubmapGraph& graph, const std::vector<std::uint32_t>& submaps, std::uint32_t fixed);

// Also the landmarks that two keyframes of these submaps see. `free` move; other submaps whose keyframes see their landmarks take part as
// they are. When there are none, the first of `free` stays. Where everything lies tells how well it was tracked: after a pose graph,
// tracked links count as much more than information_of() says as their loops had less to correct.
BundleOfMap bundle_of(const SparseMap& map, const SubmapGraph& graph, const std::vector<std::uint32_t>& free);

// What became of the map since the problem was made stays: landmarks that were moved to another one, keyframes that came. Observations that
// turned out wrong are taken out of their landmarks. Submaps outside the scope do not move.
void apply(const BundleSolution& solution, const BundleScope& scope, SparseMap& map);

}  // namespace hermite
