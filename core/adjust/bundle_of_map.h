// Conversion of submaps, keyframes and landmarks to a bundle problem, and of its solution back.
#pragma once

#include <vector>

#include "core/adjust/bundle.h"
#include "core/adjust/sparse_map.h"
#include "core/adjust/submap_graph.h"

namespace hermite::adjust {

// The map elements that a problem contains: indices into the map, in the order of the problem.
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

// Builds a pose graph: only the links between the submaps. The submap `fixed` is held. Loops are
// not robust here, so the map moves to where they say, however far; the caller must check whether
// the other links agree.
BundleOfMap pose_graph_of(const SparseMap& map, const SubmapGraph& graph,
                          const std::vector<std::uint32_t>& submaps, std::uint32_t fixed);

// Builds a problem that also has the landmarks seen by at least two keyframes of these submaps.
// `free` submaps move; other submaps whose keyframes see these landmarks take part as fixed. If
// there are none, the first of `free` is fixed. The current layout shows how accurate tracking was:
// after a pose graph, the less the loops had to correct, the more weight tracked links get beyond
// information_of() (variance_of_tracking()).
BundleOfMap bundle_of(const SparseMap& map, const SubmapGraph& graph,
                      const std::vector<std::uint32_t>& free);

// Applies a solution. Changes to the map since the problem was made are kept: merged landmarks and
// new keyframes. Outlier observations are removed from their landmarks. Submaps outside the scope
// do not move.
void apply(const BundleSolution& solution, const BundleScope& scope, SparseMap& map);

}  // namespace hermite::adjust
