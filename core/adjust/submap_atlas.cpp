#include "core/adjust/submap_atlas.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hermite::adjust {

namespace {

constexpr double kRadians = M_PI / 180;

// The camera returns to an old submap if it is within this share of the submap's reach. It is well
// below 1 so that the camera does not alternate between two submaps.
constexpr double kBackShare = 0.7;

// Two views this close show much of the same surface.
constexpr double kNearView_m = 1.0, kNearView_rad = 40 * kRadians;

// A new submap is linked to this many other active submaps besides the previous one.
constexpr std::size_t kTies = 3;

// The range of a depth camera, and the largest rotation at which two views still overlap.
constexpr double kInView_m = 3.0, kInView_rad = M_PI / 2;

// Returns the distances and indices of active submaps around the camera, nearest first: those whose
// origin is within three times the reach, turned by at most twice the reach.
std::vector<std::pair<double, std::uint32_t>> active_submaps_around(const SubmapAtlas& atlas,
                                                                    double reach_m,
                                                                    double reach_rad) {
  const Rigid3 camera = world_from_camera(atlas);
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t submap = 0; submap < atlas.layout.is_active.size(); ++submap) {
    const Rigid3 submap_from_camera = inverse(atlas.map.world_from_submap[submap]) * camera;
    if (atlas.layout.is_active[submap] && is_within(submap_from_camera, 3 * reach_m, 2 * reach_rad))
      near.emplace_back(length_of(submap_from_camera), submap);
  }
  std::sort(near.begin(), near.end());
  return near;
}

}  // namespace

SubmapAtlas make_submap_atlas(const Camera& camera) {
  SubmapAtlas atlas;
  atlas.map.camera = camera;
  atlas.map.world_from_submap = atlas.layout.world_from_submap;
  add_submap(atlas.graph, 0);
  return atlas;
}

Rigid3 world_from_camera(const SubmapAtlas& atlas) {
  return atlas.map.world_from_submap[atlas.layout.current] * atlas.submap_from_camera;
}

std::uint32_t open_submap(SubmapAtlas& atlas, const Rigid3& world_from_submap,
                          std::uint32_t component) {
  atlas.map.world_from_submap.push_back(world_from_submap);
  atlas.layout.is_active.push_back(true);
  const std::uint32_t submap = add_submap(atlas.graph, component);
  publish(atlas);
  return submap;
}

void update_active(SubmapAtlas& atlas, const AdjustOptions& options) {
  const std::vector<std::uint32_t>& component = atlas.graph.component;
  const std::vector<double> way_m = distances_m(atlas.graph, atlas.layout.current);
  for (std::size_t submap = 0; submap < way_m.size(); ++submap) {
    const bool same_component = component[submap] == component[atlas.layout.current];
    atlas.layout.is_active[submap] =
        options.global_bundle_adjustment ? way_m[submap] <= options.active_path_m : same_component;
  }
}

std::uint32_t open_component(SubmapAtlas& atlas, const Rigid3& world_from_camera, double reach_m) {
  const std::uint32_t before = atlas.layout.current;
  const Eigen::Vector3d last_place_m =
      inverse(atlas.map.world_from_submap[before]) * world_from_camera.translation;
  const std::uint32_t after = open_submap(atlas, world_from_camera, atlas.component_count++);
  atlas.losses.push_back({before, after, last_place_m, reach_m});
  return after;
}

bool is_out_of_reach(const SubmapAtlas& atlas) {
  return std::ranges::any_of(atlas.losses, [&atlas](const SightLoss& loss) {
    const std::vector<Rigid3>& world_from_submap = atlas.map.world_from_submap;
    return atlas.graph.component[loss.before] == atlas.graph.component[loss.after] &&
           (world_from_submap[loss.before] * loss.last_place_m -
            world_from_submap[loss.after].translation)
                   .norm() > loss.reach_m;
  });
}

void enter_submap(SubmapAtlas& atlas, std::uint32_t submap, const Rigid3& world_from_camera,
                  const AdjustOptions& options) {
  atlas.layout.current = submap;
  atlas.submap_from_camera = inverse(atlas.map.world_from_submap[submap]) * world_from_camera;
  update_active(atlas, options);
}

bool choose_submap(SubmapAtlas& atlas, const AdjustOptions& options) {
  const double reach_m = options.submap_distance_m, reach_rad = options.submap_turn_deg * kRadians;
  if (is_within(atlas.submap_from_camera, reach_m, reach_rad)) return false;
  const Rigid3 camera = world_from_camera(atlas);
  const std::uint32_t before = atlas.layout.current;
  const auto near = active_submaps_around(atlas, reach_m, reach_rad);
  const auto reaches = [&](const auto& candidate) {
    return is_within(inverse(atlas.map.world_from_submap[candidate.second]) * camera,
                     kBackShare * reach_m, kBackShare * reach_rad);
  };
  const auto back = std::find_if(near.begin(), near.end(), reaches);
  const bool opens = back == near.end();
  const std::uint32_t submap =
      opens ? open_submap(atlas, camera, atlas.graph.component[before]) : back->second;
  if (opens) atlas.graph.parent[submap] = before;
  const auto tie = [&](std::uint32_t other) {
    const std::vector<Rigid3>& world_from_submap = atlas.map.world_from_submap;
    if (other != submap)
      link_tracked(atlas.graph, other, submap,
                   inverse(world_from_submap[other]) * world_from_submap[submap]);
  };
  tie(before);
  for (std::size_t i = 0; i < std::min(near.size(), kTies); ++i) tie(near[i].second);
  enter_submap(atlas, submap, camera, options);
  return opens;
}

std::vector<std::uint32_t> submaps_of(const SubmapGraph& graph, std::uint32_t component) {
  std::vector<std::uint32_t> submaps;
  for (std::uint32_t submap = 0; submap < graph.component.size(); ++submap)
    if (graph.component[submap] == component) submaps.push_back(submap);
  return submaps;
}

std::vector<std::uint32_t> keyframes_near(const SubmapAtlas& atlas, double distance_m,
                                          double turn_rad, bool active) {
  const SparseMap& map = atlas.map;
  const std::vector<std::uint32_t>& component = atlas.graph.component;
  const Rigid3 camera_from_world = inverse(world_from_camera(atlas));
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t i = 0; i < map.keyframes.size(); ++i) {
    const std::uint32_t submap = map.keyframes[i].submap;
    if (atlas.layout.is_active[submap] != active ||
        component[submap] != component[atlas.layout.current])
      continue;
    const Rigid3 camera_from_keyframe =
        camera_from_world * world_from_camera(map, map.keyframes[i]);
    if (is_within(camera_from_keyframe, distance_m, turn_rad))
      near.emplace_back(length_of(camera_from_keyframe), i);
  }
  std::sort(near.begin(), near.end());
  std::vector<std::uint32_t> keyframes;
  for (const auto& [length, keyframe] : near) keyframes.push_back(keyframe);
  return keyframes;
}

std::vector<std::uint32_t> keyframes_in_view(const SubmapAtlas& atlas, bool active) {
  return keyframes_near(atlas, kNearView_m, kNearView_rad, active);
}

bool is_new_view(const SubmapAtlas& atlas, const AdjustOptions& options) {
  return keyframes_near(atlas, options.keyframe_distance_m, options.keyframe_turn_deg * kRadians,
                        true)
      .empty();
}

std::vector<bool> submaps_in_view(const SubmapAtlas& atlas, const Rigid3& world_from_camera,
                                  std::uint32_t component) {
  std::vector<bool> submaps(atlas.graph.component.size(), false);
  const Rigid3 camera_from_world = inverse(world_from_camera);
  for (const Keyframe& keyframe : atlas.map.keyframes)
    if (atlas.graph.component[keyframe.submap] == component &&
        is_within(camera_from_world * adjust::world_from_camera(atlas.map, keyframe), kInView_m,
                  kInView_rad))
      submaps[keyframe.submap] = true;
  return submaps;
}

std::uint32_t nearest_submap(const SubmapAtlas& atlas, const std::vector<bool>& among,
                             const Rigid3& world_from_camera) {
  std::uint32_t nearest = atlas.layout.current;
  double least = 1e300;
  for (std::uint32_t submap = 0; submap < among.size(); ++submap) {
    const double length =
        length_of(inverse(atlas.map.world_from_submap[submap]) * world_from_camera);
    if (!among[submap] || length >= least) continue;
    nearest = submap;
    least = length;
  }
  return nearest;
}

LoopCandidate candidate_at(const SubmapAtlas& atlas, const Rigid3& world_from_camera,
                           std::uint32_t submap, bool by_appearance) {
  LoopCandidate candidate{world_from_camera,
                          submaps_in_view(atlas, world_from_camera, atlas.graph.component[submap]),
                          by_appearance};
  for (std::size_t i = 0; i < candidate.submaps.size(); ++i)
    candidate.submaps[i] = candidate.submaps[i] && !atlas.layout.is_active[i];
  return candidate;
}

bool is_of_another_component(const SubmapAtlas& atlas, const LoopCandidate& candidate) {
  const auto seen = std::find(candidate.submaps.begin(), candidate.submaps.end(), true);
  const std::vector<std::uint32_t>& component = atlas.graph.component;
  return seen != candidate.submaps.end() &&
         component[static_cast<std::size_t>(seen - candidate.submaps.begin())] !=
             component[atlas.layout.current];
}

void publish(SubmapAtlas& atlas) {
  atlas.layout.world_from_submap = atlas.map.world_from_submap;
  atlas.layout.component = atlas.graph.component;
}

void publish_correction(SubmapAtlas& atlas) {
  publish(atlas);
  ++atlas.layout.correction_count;
}

}  // namespace hermite::adjust
