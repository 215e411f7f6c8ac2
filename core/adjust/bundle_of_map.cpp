#include "core/adjust/bundle_of_map.h"

#include <algorithm>
#include <cmath>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/bundle_residuals.h"

namespace hermite::adjust {

namespace {

constexpr std::uint32_t kOutside = 0xffffffffu;
// Median of the absolute value of a normal variable, in standard deviations.
constexpr double kMedianOfNormal = 0.6745;

// Returns for each index of the map its index in the problem.
std::vector<std::uint32_t> problem_indices_of(const std::vector<std::uint32_t>& members,
                                              std::size_t count) {
  std::vector<std::uint32_t> places(count, kOutside);
  for (std::size_t i = 0; i < members.size(); ++i)
    places[members[i]] = static_cast<std::uint32_t>(i);
  return places;
}

// Tracked links get `tracked_variance` times the variance that information_of() states.
void add_links(const SubmapGraph& graph, const std::vector<std::uint32_t>& place_of_submap,
               bool loops_may_be_wrong, double tracked_variance, BundleProblem& problem) {
  for (const SubmapLink& link : graph.links) {
    const std::uint32_t from = place_of_submap[link.from], to = place_of_submap[link.to];
    if (from == kOutside || to == kOutside || (problem.is_fixed[from] && problem.is_fixed[to]))
      continue;
    const Matrix6d information = information_of(link) / (link.is_loop ? 1.0 : tracked_variance);
    problem.links.push_back(
        {from, to, link.from_from_to, information, link.is_loop && loops_may_be_wrong});
  }
}

// Estimates the variance of this scan's tracking as the chi-square that the tracked links have at
// the current layout, after a pose graph. Each loop contributes six degrees of freedom; one more
// stands for the prior of information_of(), which is also the upper bound.
double variance_of_tracking(const SparseMap& map, const SubmapGraph& graph,
                            const std::vector<std::uint32_t>& place_of_submap) {
  double chi2 = 0;
  int loop_count = 0;
  for (const SubmapLink& link : graph.links) {
    if (place_of_submap[link.from] == kOutside || place_of_submap[link.to] == kOutside) continue;
    loop_count += link.is_loop ? 1 : 0;
    if (link.is_loop) continue;
    const Vector6d off = link_residual(link.from_from_to, map.world_from_submap[link.from],
                                       map.world_from_submap[link.to], nullptr);
    chi2 += off.dot(information_of(link) * off);
  }
  return std::min(1.0, (chi2 + 1) / (6 * loop_count + 1));
}

// Returns landmarks seen by at least two keyframes, one of them of a submap in `free`.
std::vector<std::uint32_t> landmarks_seen_by(const SparseMap& map,
                                             const std::vector<std::uint32_t>& place_of_free) {
  std::vector<std::uint32_t> landmarks;
  for (std::uint32_t i = 0; i < map.landmarks.size(); ++i) {
    const std::vector<Observation>& observations = map.landmarks[i].observations;
    const bool is_seen =
        std::any_of(observations.begin(), observations.end(), [&](const Observation& o) {
          return place_of_free[map.keyframes[o.keyframe].submap] != kOutside;
        });
    if (is_seen && observations.size() >= 2) landmarks.push_back(i);
  }
  return landmarks;
}

void add_observations(const SparseMap& map, BundleOfMap& bundle) {
  const std::vector<std::uint32_t> place_of_submap =
      problem_indices_of(bundle.scope.submaps, map.world_from_submap.size());
  std::vector<std::uint32_t> place_of_keyframe(map.keyframes.size(), kOutside);
  BundleProblem& problem = bundle.problem;
  for (std::uint32_t landmark = 0; landmark < bundle.scope.landmarks.size(); ++landmark) {
    const Landmark& point = map.landmarks[bundle.scope.landmarks[landmark]];
    problem.landmarks_in_world.push_back(position_in_world_m(map, point));
    for (const Observation& observation : point.observations) {
      const Keyframe& keyframe = map.keyframes[observation.keyframe];
      if (place_of_submap[keyframe.submap] == kOutside) continue;
      std::uint32_t& place = place_of_keyframe[observation.keyframe];
      if (place == kOutside) {
        place = static_cast<std::uint32_t>(problem.keyframes.size());
        problem.keyframes.push_back(
            {place_of_submap[keyframe.submap], keyframe.submap_from_camera});
      }
      const Feature& feature = keyframe.features[observation.feature];
      problem.observations.push_back({place, landmark, feature.pixel_px.cast<double>(),
                                      feature.depth_m, octave_scale(feature.octave)});
      bundle.scope.sightings.push_back({bundle.scope.landmarks[landmark], observation});
    }
  }
}

// Returns the robust standard deviation of the whitened pixel residuals at the current layout, at
// least 1. Cameras with badly registered colour and depth see landmarks displaced, in the same way
// in every frame; then tracking by depth, which the links represent, is more accurate.
double misfit(const BundleProblem& problem) {
  std::vector<double> off;
  const std::vector<KeyframeView> views = views_of(problem);
  for (const BundleObservation& observation : problem.observations) {
    const Rigid3& world_from_submap =
        problem.world_from_submap[problem.keyframes[observation.keyframe].submap];
    const ObservationResidual residual =
        observation_residual(observation, views[observation.keyframe], world_from_submap,
                             problem.landmarks_in_world[observation.landmark], nullptr);
    if (residual.landmark_depth_m < kNearest_m) continue;
    for (int i = 0; i < 2; ++i) off.push_back(std::abs(residual.whitened[i]));
  }
  if (off.empty()) return 1;
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return std::max(1.0, *middle / kMedianOfNormal);
}

void weigh_keyframes(BundleProblem& problem) {
  std::vector<std::size_t> counts(problem.keyframes.size(), 0);
  for (const BundleObservation& observation : problem.observations) ++counts[observation.keyframe];
  for (std::size_t i = 0; i < counts.size(); ++i)
    problem.keyframes[i].weight = weight_of_observation(counts[i], problem.camera.fx);
}

// Whether the landmark still has this observation among several; the map may have changed since the
// problem was made.
bool can_be_taken_back(const SparseMap& map, const BundleScope::Sighting& sighting) {
  const std::vector<Observation>& observations = map.landmarks[sighting.landmark].observations;
  return observations.size() > 1 && std::find(observations.begin(), observations.end(),
                                              sighting.observation) != observations.end();
}

}  // namespace

BundleOfMap pose_graph_of(const SparseMap& map, const SubmapGraph& graph,
                          const std::vector<std::uint32_t>& submaps, std::uint32_t fixed) {
  BundleOfMap bundle;
  bundle.scope.submaps = submaps;
  bundle.problem.camera = map.camera;
  for (const std::uint32_t submap : submaps) {
    bundle.problem.world_from_submap.push_back(map.world_from_submap[submap]);
    bundle.problem.is_fixed.push_back(submap == fixed);
  }
  add_links(graph, problem_indices_of(submaps, map.world_from_submap.size()), false, 1,
            bundle.problem);
  return bundle;
}

BundleOfMap bundle_of(const SparseMap& map, const SubmapGraph& graph,
                      const std::vector<std::uint32_t>& free) {
  BundleOfMap bundle;
  const std::vector<std::uint32_t> place_of_free =
      problem_indices_of(free, map.world_from_submap.size());
  bundle.scope.landmarks = landmarks_seen_by(map, place_of_free);
  std::vector<bool> takes_part(map.world_from_submap.size(), false);
  for (const std::uint32_t landmark : bundle.scope.landmarks)
    for (const Observation& o : map.landmarks[landmark].observations)
      takes_part[map.keyframes[o.keyframe].submap] = true;
  bundle.scope.submaps = free;
  for (std::uint32_t submap = 0; submap < takes_part.size(); ++submap)
    if (takes_part[submap] && place_of_free[submap] == kOutside)
      bundle.scope.submaps.push_back(submap);
  bundle.problem.camera = map.camera;
  for (std::size_t i = 0; i < bundle.scope.submaps.size(); ++i) {
    bundle.problem.world_from_submap.push_back(map.world_from_submap[bundle.scope.submaps[i]]);
    bundle.problem.is_fixed.push_back(i >= free.size());
  }
  if (bundle.scope.submaps.size() == free.size()) bundle.problem.is_fixed[0] = true;
  const std::vector<std::uint32_t> place_of_submap =
      problem_indices_of(bundle.scope.submaps, map.world_from_submap.size());
  add_links(graph, place_of_submap, true, variance_of_tracking(map, graph, place_of_submap),
            bundle.problem);
  add_observations(map, bundle);
  const double factor = misfit(bundle.problem);
  for (BundleObservation& observation : bundle.problem.observations) observation.scale *= factor;
  weigh_keyframes(bundle.problem);
  return bundle;
}

void apply(const BundleSolution& solution, const BundleScope& scope, SparseMap& map) {
  for (std::size_t i = 0; i < scope.submaps.size(); ++i)
    map.world_from_submap[scope.submaps[i]] = solution.world_from_submap[i];
  for (std::size_t i = 0; i < solution.landmarks_in_world.size(); ++i) {
    Landmark& landmark = map.landmarks[scope.landmarks[i]];
    if (landmark.observations.empty()) continue;
    landmark.position_in_submap_m =
        inverse(map.world_from_submap[landmark.submap]) * solution.landmarks_in_world[i];
  }
  for (std::size_t i = 0; i < scope.sightings.size(); ++i)
    if (!solution.observation_is_inlier[i] && can_be_taken_back(map, scope.sightings[i]))
      remove_observation(map, scope.sightings[i].landmark, scope.sightings[i].observation);
}

}  // namespace hermite::adjust
