// SubmapMapping and the places it has come back to: which may be in view, how a loop is measured, believed, and closed.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/submap_mapping.h"

namespace hermite {

namespace {

// Near submaps are candidates every so many keyframes: a verification costs as much as a frame.
constexpr std::int64_t kNearInterval = 4;

// As far as a depth camera sees, and as wide as it turns without losing all of a view.
constexpr double kInView_m = 3.0, kInView_rad = M_PI / 2;

// A verification whose frame shares so much of its view with the place closes the loop at once; before that it is repeated at every
// keyframe, until so many keyframes or frames have not seen more. Coming back to a place by a corridor, an alignment over 31 % of the view
// was off by 5.8 mm, over 41 % by 2.8, over 54 % by 1.4, and from 60 % on by 0.4 to 1 (tests/accuracy/LAB.md).
constexpr double kSeenWell = 0.6;
constexpr std::int64_t kPatientKeyframes = 3, kPatientFrames = 45;
constexpr std::uint32_t kMostVerifications = 15;

// One place is meant when the next best has fewer inliers than this share: identical rooms have nearly as many.
constexpr double kAmbiguous = 0.7;

// So many recognised places are candidates.
constexpr std::size_t kPlaces = 2;

// A correction smaller than the noise of tracking is not worth another prediction.
constexpr double kSmall_m = 0.001, kSmall_rad = 0.0005;

bool is_small(const Rigid3& motion) { return motion.translation.norm() < kSmall_m && angle_rad(motion.rotation) < kSmall_rad; }

// Best first: does the first look like no other place?
bool is_unmistakable(const std::vector<PlaceMatch>& places) {
  return places.size() < 2 || static_cast<double>(places[1].matches.size()) < kAmbiguous * static_cast<double>(places[0].matches.size());
}

}  // namespace

// Those of the component with a keyframe whose view is near that of a camera there.
std::vector<bool> SubmapMapping::submaps_in_view(const Rigid3& world_from_camera, std::uint32_t component) const {
  std::vector<bool> submaps(graph_.component.size(), false);
  const Rigid3 camera_from_world = inverse(world_from_camera);
  for (const Keyframe& keyframe : map_.keyframes)
    if (graph_.component[keyframe.submap] == component &&
        is_within(camera_from_world * hermite::world_from_camera(map_, keyframe), kInView_m, kInView_rad))
      submaps[keyframe.submap] = true;
  return submaps;
}

// What a camera there could see of the component of `submap`, without what is active.
LoopCandidate SubmapMapping::candidate_at(const Rigid3& world_from_camera, std::uint32_t submap, bool by_appearance) const {
  LoopCandidate candidate{world_from_camera, submaps_in_view(world_from_camera, graph_.component[submap]), by_appearance};
  for (std::size_t i = 0; i < graph_.component.size(); ++i)
    candidate.submaps[i] = candidate.submaps[i] && !is_active(static_cast<std::uint32_t>(i));
  return candidate;
}

// Places among the inactive submaps that show what the features show, as far as the camera can have come there.
std::vector<LoopCandidate> SubmapMapping::recognised(const std::vector<Feature>& features) {
  std::vector<std::uint32_t> excluded;
  for (std::uint32_t i = 0; i < map_.keyframes.size(); ++i)
    if (is_active(map_.keyframes[i].submap)) excluded.push_back(i);
  if (excluded.size() == map_.keyframes.size()) return {};
  const std::vector<PlaceMatch> places = recognise(map_, index_, features, excluded);
  const std::vector<double> way_m = distances_m(graph_, layout_.current);
  std::vector<LoopCandidate> candidates;
  for (const PlaceMatch& place : places) {
    const Rigid3 there = map_.world_from_submap[place.submap] * place.submap_from_camera;
    const bool same_component = graph_.component[place.submap] == graph_.component[layout_.current];
    // Of another component only the appearance is known: then it must look like nothing else.
    const bool possible =
        same_component ? is_possible_drift(inverse(world_from_camera()) * there, way_m[place.submap]) : is_unmistakable(places);
    if (!possible) ++counts_.impossible_places;
    if (possible) candidates.push_back(candidate_at(there, place.submap, true));
    if (candidates.size() == kPlaces) break;
  }
  return candidates;
}

// Inactive submaps that the camera should see if it has not drifted.
std::vector<LoopCandidate> SubmapMapping::near_inactive() {
  const auto keyframe = static_cast<std::int64_t>(map_.keyframes.size());
  if (keyframe < offered_at_keyframe_ + kNearInterval) return {};
  const std::vector<std::uint32_t> near = keyframes_in_view(false);
  if (near.empty()) return {};
  offered_at_keyframe_ = keyframe;
  return {candidate_at(world_from_camera(), map_.keyframes[near.front()].submap, false)};
}

std::uint32_t SubmapMapping::nearest_submap(const std::vector<bool>& among, const Rigid3& world_from_camera) const {
  std::uint32_t nearest = layout_.current;
  double least = 1e300;
  for (std::uint32_t submap = 0; submap < among.size(); ++submap) {
    const double length = length_of(inverse(map_.world_from_submap[submap]) * world_from_camera);
    if (!among[submap] || length >= least) continue;
    nearest = submap;
    least = length;
  }
  return nearest;
}

// Where in the world the loop says that the submap it starts from stands.
Rigid3 SubmapMapping::placed_by(const SubmapLink& loop) const { return map_.world_from_submap[loop.to] * inverse(loop.from_from_to); }

bool SubmapMapping::is_of_another_component(const LoopCandidate& candidate) const {
  const auto seen = std::find(candidate.submaps.begin(), candidate.submaps.end(), true);
  return seen != candidate.submaps.end() &&
         graph_.component[static_cast<std::size_t>(seen - candidate.submaps.begin())] != graph_.component[layout_.current];
}

// The place of the pending loop, from where the camera is if the loop is right.
std::vector<LoopCandidate> SubmapMapping::pending_candidate() const {
  const SubmapLink& loop = pending_->link;
  if (graph_.component[loop.from] != graph_.component[layout_.current]) return {};
  const Rigid3 from_from_camera = inverse(map_.world_from_submap[loop.from]) * world_from_camera();
  return {candidate_at(placed_by(loop) * from_from_camera, loop.to, pending_->by_appearance)};
}

// The older of the two components stays, the other one comes to where the camera sees both.
void SubmapMapping::join(const SubmapLink& loop) {
  const std::uint32_t from_component = graph_.component[loop.from], to_component = graph_.component[loop.to];
  const Rigid3 there_from_here = placed_by(loop) * inverse(map_.world_from_submap[loop.from]);
  const Rigid3 correction = to_component < from_component ? there_from_here : inverse(there_from_here);
  const std::uint32_t stays = std::min(from_component, to_component), moves = std::max(from_component, to_component);
  for (std::size_t submap = 0; submap < graph_.component.size(); ++submap) {
    if (graph_.component[submap] != moves) continue;
    map_.world_from_submap[submap] = correction * map_.world_from_submap[submap];
    graph_.component[submap] = stays;
  }
}

// Submaps move so that the loop closes (a pose graph). No: something else would have to give way too much, and nothing has moved.
bool SubmapMapping::bend(const SubmapLink& loop) {
  graph_.links.push_back(loop);
  const std::vector<std::uint32_t> submaps = submaps_of(graph_.component[loop.to]);
  const BundleOfMap bundle = pose_graph_of(map_, graph_, submaps, submaps.front());
  const Result<BundleSolution> solution = adjust(bundle.problem, {});
  const auto contradicts = [](double chi2) { return chi2 > 4 * kPoseChi2; };
  if (!solution.ok() || std::any_of(solution->link_chi2.begin(), solution->link_chi2.end(), contradicts)) {
    graph_.links.pop_back();
    return false;
  }
  apply(*solution, bundle.scope, map_);
  return true;
}

bool SubmapMapping::confirm(const LoopCandidate& candidate, const LoopVerification& verified) {
  const Rigid3 tracked = world_from_camera();
  const std::uint32_t target = nearest_submap(candidate.submaps, verified.world_from_camera);
  const bool same_component = graph_.component[target] == graph_.component[layout_.current];
  const Rigid3 drift = inverse(tracked) * verified.world_from_camera;
  if (same_component && !is_possible_drift(drift, distances_m(graph_, layout_.current)[target])) {
    ++counts_.impossible_loops;
    return false;
  }
  const Rigid3 target_from_camera = inverse(map_.world_from_submap[target]) * verified.world_from_camera;
  const SubmapLink link{layout_.current, target, submap_from_camera_ * inverse(target_from_camera), 0, true};
  const auto keyframe = static_cast<std::int64_t>(map_.keyframes.size());
  const PendingLoop loop{link,     verified.overlap,        frame_,
                         keyframe, candidate.by_appearance, pending_ ? pending_->later_verifications + 1 : 0};
  // Components are joined at once: a camera in a new one cannot tell how long it will see the old one.
  if (verified.overlap >= kSeenWell || !same_component || is_small(drift)) {
    pending_.reset();
    return close(loop);
  }
  if (!pending_ || verified.overlap > pending_->overlap) pending_ = loop;
  pending_->later_verifications = loop.later_verifications;
  return true;
}

// When the camera does not see more of the place, the loop is closed; but not if no later verification succeeded.
void SubmapMapping::close_when_seen() {
  if (!pending_) return;
  const bool was_verified_again = static_cast<std::int64_t>(map_.keyframes.size()) >= pending_->keyframe + kPatientKeyframes ||
                                  pending_->later_verifications >= kMostVerifications;
  if (!was_verified_again && frame_ < pending_->frame + kPatientFrames) return;
  const PendingLoop loop = *std::exchange(pending_, std::nullopt);
  if (was_verified_again && loop.later_verifications == 0)
    ++counts_.unrepeated_loops;
  else
    close(loop);
}

// The map is bent so that the loop closes. No: it contradicts what else is known, and nothing has moved.
bool SubmapMapping::close(const PendingLoop& loop) {
  const std::vector<std::uint32_t> components_before = graph_.component;
  const std::vector<Rigid3> poses_before = map_.world_from_submap;
  const bool same_component = graph_.component[loop.link.from] == graph_.component[loop.link.to];
  const bool has_moved = !same_component || !is_small(inverse(map_.world_from_submap[loop.link.from]) * placed_by(loop.link));
  if (!same_component) join(loop.link);
  if (!has_moved) {
    graph_.links.push_back(loop.link);
  } else if (!bend(loop.link)) {
    ++counts_.contradicting_loops;
    graph_.component = components_before;
    map_.world_from_submap = poses_before;
    return false;
  }
  ++(loop.by_appearance ? counts_.loops_by_appearance : counts_.loops_by_nearness);
  if (!same_component) ++counts_.joined_components;
  ++layout_.closure_count;
  if (has_moved) publish_correction();
  update_active();
  if (has_moved) adjust_globally();
  return true;
}

std::vector<LoopCandidate> SubmapMapping::relocalise(const RgbdFrame& frame) {
  if (!options_.global_bundle_adjustment) return {};
  const std::vector<PlaceMatch> places = recognise(map_, index_, detect_features(frame, map_.camera));
  if (places.empty()) return {};
  if (!is_unmistakable(places)) {
    ++counts_.ambiguous_places;
    return {};
  }
  const Rigid3 there = map_.world_from_submap[places[0].submap] * places[0].submap_from_camera;
  return {{there, submaps_in_view(there, graph_.component[places[0].submap]), true}};
}

}  // namespace hermite
