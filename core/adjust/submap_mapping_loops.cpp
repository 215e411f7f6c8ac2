// Loop closure of SubmapMapping: which places may be in view, and how a loop is verified, accepted
// and closed.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/repetition.h"
#include "core/adjust/submap_mapping.h"

namespace hermite {

namespace {

// Near submaps are candidates once per this many keyframes, because a verification costs as much as
// a frame.
constexpr std::int64_t kNearInterval = 4;

// The range of a depth camera, and the largest rotation at which two views still overlap.
constexpr double kInView_m = 3.0, kInView_rad = M_PI / 2;

// A verification with at least this overlap closes the loop at once. With less, it is repeated at
// every keyframe until the overlap has not grown for kPatientKeyframes keyframes or kPatientFrames
// frames. When the camera came back to a place along a corridor, an alignment with an overlap of 31
// % was off by 5.8 mm, with 41 % by 2.8, with 54 % by 1.4, and from 60 % on by 0.4 to 1
// (tests/accuracy/LAB.md).
constexpr double kSeenWell = 0.6;
constexpr std::int64_t kPatientKeyframes = 3, kPatientFrames = 45;
constexpr std::uint32_t kMostVerifications = 15;

// The largest number of recognised places that become candidates.
constexpr std::size_t kPlaces = 2;

// A correction smaller than the noise of tracking is not worth another prediction.
constexpr double kSmall_m = 0.001, kSmall_rad = 0.0005;

bool is_small(const Rigid3& motion) { return motion.translation.norm() < kSmall_m && angle_rad(motion.rotation) < kSmall_rad; }

// Returns whether the first place is unambiguous; `places` are best first.
bool is_unmistakable(const std::vector<PlaceMatch>& places) {
  return places.size() < 2 ||
         static_cast<double>(places[1].matches.size()) < kAmbiguousShare * static_cast<double>(places[0].matches.size());
}

// Returns the world pose of the submap where the loop starts, according to the loop.
Rigid3 placed_by(const SparseMap& map, const SubmapLink& loop) { return map.world_from_submap[loop.to] * inverse(loop.from_from_to); }

}  // namespace

// Returns the submaps of the component with a keyframe whose view is near that of a camera at this
// pose.
std::vector<bool> SubmapMapping::submaps_in_view(const Rigid3& world_from_camera, std::uint32_t component) const {
  std::vector<bool> submaps(graph_.component.size(), false);
  const Rigid3 camera_from_world = inverse(world_from_camera);
  for (const Keyframe& keyframe : map_.keyframes)
    if (graph_.component[keyframe.submap] == component &&
        is_within(camera_from_world * hermite::world_from_camera(map_, keyframe), kInView_m, kInView_rad))
      submaps[keyframe.submap] = true;
  return submaps;
}

// Returns a candidate with the inactive submaps of the component of `submap` that a camera at this
// pose could see.
LoopCandidate SubmapMapping::candidate_at(const Rigid3& world_from_camera, std::uint32_t submap, bool by_appearance) const {
  LoopCandidate candidate{world_from_camera, submaps_in_view(world_from_camera, graph_.component[submap]), by_appearance};
  for (std::size_t i = 0; i < graph_.component.size(); ++i)
    candidate.submaps[i] = candidate.submaps[i] && !is_active(static_cast<std::uint32_t>(i));
  return candidate;
}

// Returns candidates in inactive submaps that look like the features, if the camera can have
// drifted that far.
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
    // For another component only the appearance is known, so it must be unambiguous.
    const bool possible =
        same_component ? is_possible_drift(inverse(world_from_camera()) * there, way_m[place.submap]) : is_unmistakable(places);
    if (!possible) ++counts_.impossible_places;
    if (possible) candidates.push_back(candidate_at(there, place.submap, true));
    if (candidates.size() == kPlaces) break;
  }
  return candidates;
}

// Returns as a candidate the inactive submaps that the camera should see if it has not drifted.
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

bool SubmapMapping::is_of_another_component(const LoopCandidate& candidate) const {
  const auto seen = std::find(candidate.submaps.begin(), candidate.submaps.end(), true);
  return seen != candidate.submaps.end() &&
         graph_.component[static_cast<std::size_t>(seen - candidate.submaps.begin())] != graph_.component[layout_.current];
}

// Returns the place of the pending loop as a candidate, at the camera's pose if the loop is right.
std::vector<LoopCandidate> SubmapMapping::pending_candidate() const {
  const SubmapLink& loop = pending_->link;
  if (graph_.component[loop.from] != graph_.component[layout_.current]) return {};
  const Rigid3 from_from_camera = inverse(map_.world_from_submap[loop.from]) * world_from_camera();
  return {candidate_at(placed_by(map_, loop) * from_from_camera, loop.to, pending_->by_appearance)};
}

// Joins two components: the older one stays, the other one moves to where the camera sees both.
void SubmapMapping::join(const SubmapLink& loop) {
  const std::uint32_t from_component = graph_.component[loop.from], to_component = graph_.component[loop.to];
  const Rigid3 there_from_here = placed_by(map_, loop) * inverse(map_.world_from_submap[loop.from]);
  const Rigid3 correction = to_component < from_component ? there_from_here : inverse(there_from_here);
  const std::uint32_t stays = std::min(from_component, to_component), moves = std::max(from_component, to_component);
  for (std::size_t submap = 0; submap < graph_.component.size(); ++submap) {
    if (graph_.component[submap] != moves) continue;
    map_.world_from_submap[submap] = correction * map_.world_from_submap[submap];
    graph_.component[submap] = stays;
  }
}

// Moves submaps so that the loop closes (a pose graph). Returns false, with nothing moved, if
// another link would contradict it.
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
  // Components are joined at once, because it is unknown how long a camera in a new component will
  // see the old one.
  if (verified.overlap >= kSeenWell || !same_component || is_small(drift)) {
    pending_.reset();
    return close(loop);
  }
  if (!pending_ || verified.overlap > pending_->overlap) pending_ = loop;
  pending_->later_verifications = loop.later_verifications;
  return true;
}

// Closes the pending loop when the camera no longer sees more of the place, unless no later
// verification succeeded.
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

// Bends the map so that the loop closes. Returns false, with nothing moved, if it contradicts other
// links.
bool SubmapMapping::close(const PendingLoop& loop) {
  const std::vector<std::uint32_t> components_before = graph_.component;
  const std::vector<Rigid3> poses_before = map_.world_from_submap;
  const bool same_component = graph_.component[loop.link.from] == graph_.component[loop.link.to];
  const bool has_moved = !same_component || !is_small(inverse(map_.world_from_submap[loop.link.from]) * placed_by(map_, loop.link));
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

bool SubmapMapping::is_distinctive(const RgbdFrame& frame, const Rigid3& world_from_camera, std::int64_t known_keyframes) const {
  if (!options_.global_bundle_adjustment) return true;
  return hermite::is_distinctive(repetition_of(map_, index_, detect_features(frame, map_.camera), world_from_camera, known_keyframes));
}

}  // namespace hermite
