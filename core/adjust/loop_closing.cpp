#include "core/adjust/loop_closing.h"

#include <algorithm>
#include <vector>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/bundle_of_map.h"

namespace hermite::adjust {

namespace {

constexpr double kSmall_m = 0.001, kSmall_rad = 0.0005;

// Joins two components: the older one stays, the other one moves to where the camera sees both.
void join(SubmapAtlas& atlas, const SubmapLink& loop) {
  std::vector<Rigid3>& world_from_submap = atlas.map.world_from_submap;
  std::vector<std::uint32_t>& component = atlas.graph.component;
  const std::uint32_t from_component = component[loop.from], to_component = component[loop.to];
  const Rigid3 there_from_here = placed_by(atlas.map, loop) * inverse(world_from_submap[loop.from]);
  const Rigid3 correction =
      to_component < from_component ? there_from_here : inverse(there_from_here);
  const std::uint32_t stays = std::min(from_component, to_component),
                      moves = std::max(from_component, to_component);
  for (std::size_t submap = 0; submap < component.size(); ++submap) {
    if (component[submap] != moves) continue;
    world_from_submap[submap] = correction * world_from_submap[submap];
    component[submap] = stays;
  }
}

// Adds the link and moves submaps so that the loop closes (a pose graph). Returns false, with
// nothing moved, if another link contradicts it.
bool bend(SubmapAtlas& atlas, const SubmapLink& loop) {
  SubmapGraph& graph = atlas.graph;
  graph.links.push_back(loop);
  const std::vector<std::uint32_t> submaps = submaps_of(graph, graph.component[loop.to]);
  const BundleOfMap bundle = pose_graph_of(atlas.map, graph, submaps, submaps.front());
  const Result<BundleSolution> solution = adjust(bundle.problem, {});
  const auto contradicts = [](double chi2) { return chi2 > 4 * kPoseChi2; };
  if (!solution.ok() ||
      std::any_of(solution->link_chi2.begin(), solution->link_chi2.end(), contradicts))
    return false;
  apply(*solution, bundle.scope, atlas.map);
  return true;
}

}  // namespace

std::optional<ClosedLoop> close_loop(SubmapAtlas& atlas, const SubmapLink& loop) {
  const std::vector<std::uint32_t> components_before = atlas.graph.component;
  const std::vector<Rigid3> poses_before = atlas.map.world_from_submap;
  const std::vector<SubmapLink> links_before = atlas.graph.links;
  const bool same_component = components_before[loop.from] == components_before[loop.to];
  const bool has_moved = !same_component || !is_small_correction(inverse(poses_before[loop.from]) *
                                                                 placed_by(atlas.map, loop));
  if (!same_component) join(atlas, loop);
  if (!has_moved) {
    atlas.graph.links.push_back(loop);
  } else if (!bend(atlas, loop) || (!same_component && is_out_of_reach(atlas))) {
    atlas.graph.component = components_before;
    atlas.map.world_from_submap = poses_before;
    atlas.graph.links = links_before;
    return std::nullopt;
  }
  ++atlas.layout.closure_count;
  if (has_moved) publish_correction(atlas);
  return ClosedLoop{has_moved, !same_component};
}

Rigid3 placed_by(const SparseMap& map, const SubmapLink& loop) {
  return map.world_from_submap[loop.to] * inverse(loop.from_from_to);
}

bool is_small_correction(const Rigid3& motion) {
  return motion.translation.norm() < kSmall_m && angle_rad(motion.rotation) < kSmall_rad;
}

}  // namespace hermite::adjust
