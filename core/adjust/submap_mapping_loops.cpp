// SubmapMapping and the places it has come back to: which may be in view, how a loop is measured, believed, and closed.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/submap_mapping.h"

namespace hermite {

namespace {

// So many keyframes apart near submaps are looked at: a look costs as much as a frame.
constexpr std::int64_t kLookInterval = 4;

// As far as a depth camera sees, and as wide as it turns without losing all of a view.
constexpr double kInView_m = 3.0, kInView_rad = M_PI / 2;

// A look that shares so much of its view with the place is believed as it is; before that the camera looks again at every keyframe, until
// so many keyframes or frames have not seen more. Coming back to a place by a corridor, a first look at 31 % was off by 5.8 mm, at 41 % by
// 2.8, at 54 % by 1.4, and from 60 % on by 0.4 to 1 (tests/accuracy/LAB.md).
constexpr double kSeenWell = 0.6;
constexpr std::int64_t kPatientKeyframes = 3, kPatientFrames = 45;
constexpr std::uint32_t kMostLooks = 15;

// One place is meant when the next best has fewer inliers than this share: identical rooms have nearly as many.
constexpr double kAmbiguous = 0.7;

// So many recognised places are looked at.
constexpr std::size_t kPlaces = 2;

// A correction smaller than the noise of tracking is not worth another prediction.
constexpr double kSmall_m = 0.001, kSmall_rad = 0.0005;

bool is_small(const Rigid3& motion) { return motion.translation.norm() < kSmall_m && angle_rad(motion.rotation) < kSmall_rad; }

// Best first: does the first look like no other place?
bool is_unmistakable(const std::vector<PlaceMatch>& places) {
  return places.size() < 2 || static_cast<double>(places[1].matches.size()) < kAmbiguous * static_cast<double>(places[0].matches.size());
}

}  // namespace

// Those of the part with a keyframe that looks at what a camera there does.
std::vector<bool> SubmapMapping::submaps_in_view(const Rigid3& world_from_camera, std::uint32_t part) const {
  std::vector<bool> submaps(graph_.part.size(), false);
  const Rigid3 camera_from_world = inverse(world_from_camera);
  for (const Keyframe& keyframe : map_.keyframes)
    if (graph_.part[keyframe.submap] == part &&
        is_within(camera_from_world * hermite::world_from_camera(map_, keyframe), kInView_m, kInView_rad))
      submaps[keyframe.submap] = true;
  return submaps;
}

// What a camera there could see of the part of `submap`, but for what is active anyway.
Revisit SubmapMapping::revisit_of(const Rigid3& world_from_camera, std::uint32_t submap, bool by_appearance) const {
  Revisit revisit{world_from_camera, submaps_in_view(world_from_camera, graph_.part[submap]), by_appearance};
  for (std::size_t i = 0; i < graph_.part.size(); ++i) revisit.submaps[i] = revisit.submaps[i] && !is_active(static_cast<std::uint32_t>(i));
  return revisit;
}

// Places among the inactive submaps that show what the features show, as far as the camera can have come there.
std::vector<Revisit> SubmapMapping::recognised(const std::vector<Feature>& features) {
  std::vector<std::uint32_t> excluded;
  for (std::uint32_t i = 0; i < map_.keyframes.size(); ++i)
    if (is_active(map_.keyframes[i].submap)) excluded.push_back(i);
  if (excluded.size() == map_.keyframes.size()) return {};
  const std::vector<PlaceMatch> places = recognise(map_, index_, features, excluded);
  const std::vector<double> way_m = distances_m(graph_, layout_.current);
  std::vector<Revisit> revisits;
  for (const PlaceMatch& place : places) {
    const Rigid3 there = map_.world_from_submap[place.submap] * place.submap_from_camera;
    const bool same_part = graph_.part[place.submap] == graph_.part[layout_.current];
    // Of another part nothing is known but what it looks like: then it must look like nothing else.
    const bool possible =
        same_part ? is_possible_drift(inverse(world_from_camera()) * there, way_m[place.submap]) : is_unmistakable(places);
    if (!possible) ++counts_["impossible places"];
    if (possible) revisits.push_back(revisit_of(there, place.submap, true));
    if (revisits.size() == kPlaces) break;
  }
  return revisits;
}

// Inactive submaps that the camera should see if it has not drifted.
std::vector<Revisit> SubmapMapping::near_inactive() {
  const auto keyframe = static_cast<std::int64_t>(map_.keyframes.size());
  if (keyframe < looked_at_keyframe_ + kLookInterval) return {};
  const std::vector<std::uint32_t> near = keyframes_in_view(false);
  if (near.empty()) return {};
  looked_at_keyframe_ = keyframe;
  return {revisit_of(world_from_camera(), map_.keyframes[near.front()].submap, false)};
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

bool SubmapMapping::is_of_another_part(const Revisit& revisit) const {
  const auto seen = std::find(revisit.submaps.begin(), revisit.submaps.end(), true);
  return seen != revisit.submaps.end() &&
         graph_.part[static_cast<std::size_t>(seen - revisit.submaps.begin())] != graph_.part[layout_.current];
}

// The place of the pending loop, from where the camera must be if the loop is right.
std::vector<Revisit> SubmapMapping::look_again() const {
  const SubmapLink& loop = pending_->link;
  if (graph_.part[loop.from] != graph_.part[layout_.current]) return {};
  const Rigid3 from_from_camera = inverse(map_.world_from_submap[loop.from]) * world_from_camera();
  return {revisit_of(placed_by(loop) * from_from_camera, loop.to, pending_->by_appearance)};
}

// The older of the two parts stays, the other one comes to where the camera sees both.
void SubmapMapping::join(const SubmapLink& loop) {
  const std::uint32_t from_part = graph_.part[loop.from], to_part = graph_.part[loop.to];
  const Rigid3 there_from_here = placed_by(loop) * inverse(map_.world_from_submap[loop.from]);
  const Rigid3 correction = to_part < from_part ? there_from_here : inverse(there_from_here);
  const std::uint32_t stays = std::min(from_part, to_part), moves = std::max(from_part, to_part);
  for (std::size_t submap = 0; submap < graph_.part.size(); ++submap) {
    if (graph_.part[submap] != moves) continue;
    map_.world_from_submap[submap] = correction * map_.world_from_submap[submap];
    graph_.part[submap] = stays;
  }
}

// Submaps move so that the loop closes (a pose graph). No: something else would have to give way too much, and nothing has moved.
bool SubmapMapping::bend(const SubmapLink& loop) {
  graph_.links.push_back(loop);
  const std::vector<std::uint32_t> submaps = submaps_of(graph_.part[loop.to]);
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

bool SubmapMapping::confirm(const Revisit& revisit, const Look& look) {
  const Rigid3 tracked = world_from_camera();
  const std::uint32_t target = nearest_submap(revisit.submaps, look.world_from_camera);
  const bool same_part = graph_.part[target] == graph_.part[layout_.current];
  const Rigid3 drift = inverse(tracked) * look.world_from_camera;
  if (same_part && !is_possible_drift(drift, distances_m(graph_, layout_.current)[target])) {
    ++counts_["impossible loops"];
    return false;
  }
  const Rigid3 target_from_camera = inverse(map_.world_from_submap[target]) * look.world_from_camera;
  const SubmapLink link{layout_.current, target, submap_from_camera_ * inverse(target_from_camera), 0, true};
  const auto keyframe = static_cast<std::int64_t>(map_.keyframes.size());
  const PendingLoop loop{link, look.overlap, frame_, keyframe, revisit.by_appearance, pending_ ? pending_->later_looks + 1 : 0};
  // Parts are joined at once: a camera in a new one cannot tell how long it will see the old one.
  if (look.overlap >= kSeenWell || !same_part || is_small(drift)) {
    pending_.reset();
    return close(loop);
  }
  if (!pending_ || look.overlap > pending_->overlap) pending_ = loop;
  pending_->later_looks = loop.later_looks;
  return true;
}

// When the camera does not see more of the place, the loop is believed; but not if it looked again and nothing fitted any more.
void SubmapMapping::close_when_seen() {
  if (!pending_) return;
  const bool has_looked =
      static_cast<std::int64_t>(map_.keyframes.size()) >= pending_->keyframe + kPatientKeyframes || pending_->later_looks >= kMostLooks;
  if (!has_looked && frame_ < pending_->frame + kPatientFrames) return;
  const PendingLoop loop = *std::exchange(pending_, std::nullopt);
  if (has_looked && loop.later_looks == 0)
    ++counts_["unrepeated loops"];
  else
    close(loop);
}

// The map is bent so that the loop closes. No: it contradicts what else is known, and nothing has moved.
bool SubmapMapping::close(const PendingLoop& loop) {
  const std::vector<std::uint32_t> parts_before = graph_.part;
  const std::vector<Rigid3> poses_before = map_.world_from_submap;
  const bool same_part = graph_.part[loop.link.from] == graph_.part[loop.link.to];
  const bool has_moved = !same_part || !is_small(inverse(map_.world_from_submap[loop.link.from]) * placed_by(loop.link));
  if (!same_part) join(loop.link);
  if (!has_moved) {
    graph_.links.push_back(loop.link);
  } else if (!bend(loop.link)) {
    ++counts_["contradicting loops"];
    graph_.part = parts_before;
    map_.world_from_submap = poses_before;
    return false;
  }
  ++counts_[loop.by_appearance ? "loops by appearance" : "loops by nearness"];
  if (!same_part) ++counts_["joined parts"];
  ++layout_.closure_count;
  if (has_moved) publish_correction();
  update_active();
  if (has_moved) adjust_globally();
  return true;
}

std::vector<Revisit> SubmapMapping::find(const RgbdFrame& frame) {
  if (!options_.global_bundle_adjustment) return {};
  const std::vector<PlaceMatch> places = recognise(map_, index_, detect_features(frame, map_.camera));
  if (places.empty()) return {};
  if (!is_unmistakable(places)) {
    ++counts_["ambiguous places"];
    return {};
  }
  const Rigid3 there = map_.world_from_submap[places[0].submap] * places[0].submap_from_camera;
  return {{there, submaps_in_view(there, graph_.part[places[0].submap]), true}};
}

}  // namespace hermite
