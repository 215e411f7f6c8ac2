#include "core/adjust/submap_mapping.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/landmarks.h"

namespace hermite {

namespace {

constexpr double kRadians = M_PI / 180;

// So near an old submap the camera goes back into it, before it would open a new one: well inside, so that it does not change to and fro.
constexpr double kBackShare = 0.7;

// Views of inactive submaps that are looked at, and so many keyframes apart: a look costs as much as a frame.
constexpr double kNearView_m = 1.0, kNearView_rad = 40 * kRadians;
constexpr std::int64_t kLookInterval = 4;

// As far as a depth camera sees, and as wide as it turns without losing all of a view.
constexpr double kInView_m = 3.0, kInView_rad = 90 * kRadians;

// Keyframes around the camera whose landmarks are looked for beside those of the last ones.
constexpr std::size_t kNearKeyframes = 10;

// A new submap is tied to so many others that were tracked against as well.
constexpr std::size_t kTies = 3;

// A look that shares so much of its view with the place is believed as it is; before that the camera looks again at every keyframe, until
// so many keyframes or frames have not seen more. Coming back to a place by a corridor, a first look at 31 % was off by 5.8 mm, at 41 % by
// 2.8, at 54 % by 1.4, and from 60 % on by 0.4 to 1 (tests/accuracy/README.md).
constexpr double kSeenWell = 0.6;
constexpr std::int64_t kPatientKeyframes = 3, kPatientFrames = 45;

// One place is meant when the next best has fewer inliers than this share: identical rooms have nearly as many.
constexpr double kAmbiguous = 0.7;

// So many recognised places are looked at.
constexpr std::size_t kPlaces = 2;

// Submaps around the camera that local adjustment moves.
constexpr std::size_t kLocalSubmaps = 10;

// Adjustment gets so many frames, and one more for so many observations: a core adjusts 46 of them a millisecond (148,000 in 3.2 s), and a
// camera of 30 Hz gives it 33 ms a frame.
constexpr std::int64_t kDelayFrames = 5;
constexpr std::size_t kObservationsPerFrame = 2000;

// A correction smaller than the noise of tracking is not worth another prediction.
constexpr double kSmall_m = 0.001, kSmall_rad = 0.0005;

bool is_small(const Rigid3& motion) { return motion.translation.norm() < kSmall_m && angle_rad(motion.rotation) < kSmall_rad; }

bool is_within(const Rigid3& a_from_b, double distance_m, double turn_rad) {
  return a_from_b.translation.norm() < distance_m && angle_rad(a_from_b.rotation) < turn_rad;
}

// Best first: does the first look like no other place?
bool is_unmistakable(const std::vector<PlaceMatch>& places) {
  return places.size() < 2 || static_cast<double>(places[1].matches.size()) < kAmbiguous * static_cast<double>(places[0].matches.size());
}

}  // namespace

SubmapMapping::SubmapMapping(const Camera& camera, const AdjustOptions& options, CorrectionTime time)
    : options_(options), time_(time), adjuster_(std::make_unique<Adjuster>()) {
  map_.camera = camera;
  map_.world_from_submap = layout_.world_from_submap;
  add_submap(graph_, 0);
}

std::uint32_t SubmapMapping::open_submap(const Rigid3& world_from_submap, std::uint32_t part) {
  map_.world_from_submap.push_back(world_from_submap);
  layout_.is_active.push_back(true);
  const std::uint32_t submap = add_submap(graph_, part);
  publish();
  return submap;
}

// Which submaps are tracked against: those over a way so short that tracking has not drifted.
void SubmapMapping::update_active() {
  const std::vector<double> way_m = distances_m(graph_, layout_.current);
  for (std::size_t submap = 0; submap < way_m.size(); ++submap) {
    const bool same_part = graph_.part[submap] == graph_.part[layout_.current];
    layout_.is_active[submap] = options_.global_bundle_adjustment ? way_m[submap] <= options_.active_path_m : same_part;
  }
}

void SubmapMapping::go_on_in(std::uint32_t submap, const Rigid3& world_from_camera) {
  layout_.current = submap;
  submap_from_camera_ = inverse(map_.world_from_submap[submap]) * world_from_camera;
  update_active();
}

// Beyond the reach of the current submap the camera goes on in one that is there, or opens another.
void SubmapMapping::choose_submap() {
  const double reach_m = options_.submap_distance_m, reach_rad = options_.submap_turn_deg * kRadians;
  if (is_within(submap_from_camera_, reach_m, reach_rad)) return;
  const Rigid3 camera = world_from_camera();
  const std::uint32_t before = layout_.current;
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t submap = 0; submap < layout_.is_active.size(); ++submap) {
    const Rigid3 submap_from_camera = inverse(map_.world_from_submap[submap]) * camera;
    if (is_active(submap) && is_within(submap_from_camera, 3 * reach_m, 2 * reach_rad))
      near.emplace_back(length_of(submap_from_camera), submap);
  }
  std::sort(near.begin(), near.end());
  const auto reaches = [&](const auto& candidate) {
    return is_within(inverse(map_.world_from_submap[candidate.second]) * camera, kBackShare * reach_m, kBackShare * reach_rad);
  };
  const auto back = std::find_if(near.begin(), near.end(), reaches);
  const bool opens = back == near.end();
  const std::uint32_t submap = opens ? open_submap(camera, graph_.part[before]) : back->second;
  if (opens) graph_.parent[submap] = before;
  const auto tie = [&](std::uint32_t other) {
    if (other != submap) link_tracked(graph_, other, submap, inverse(map_.world_from_submap[other]) * map_.world_from_submap[submap]);
  };
  tie(before);
  for (std::size_t i = 0; i < std::min(near.size(), kTies); ++i) tie(near[i].second);
  go_on_in(submap, camera);
  if (opens && options_.local_bundle_adjustment) adjust_locally();
}

// Of those in active submaps, or of the others of this part: nearest first.
std::vector<std::uint32_t> SubmapMapping::keyframes_near(double distance_m, double turn_rad, bool active) const {
  const Rigid3 camera_from_world = inverse(world_from_camera());
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t i = 0; i < map_.keyframes.size(); ++i) {
    const std::uint32_t submap = map_.keyframes[i].submap;
    if (is_active(submap) != active || graph_.part[submap] != graph_.part[layout_.current]) continue;
    const Rigid3 camera_from_keyframe = camera_from_world * hermite::world_from_camera(map_, map_.keyframes[i]);
    if (is_within(camera_from_keyframe, distance_m, turn_rad)) near.emplace_back(length_of(camera_from_keyframe), i);
  }
  std::sort(near.begin(), near.end());
  std::vector<std::uint32_t> keyframes;
  for (const auto& [length, keyframe] : near) keyframes.push_back(keyframe);
  return keyframes;
}

bool SubmapMapping::is_new_view() const {
  return keyframes_near(options_.keyframe_distance_m, options_.keyframe_turn_deg * kRadians, true).empty();
}

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
  const std::vector<std::uint32_t> near = keyframes_near(kNearView_m, kNearView_rad, false);
  if (near.empty()) return {};
  looked_at_keyframe_ = keyframe;
  return {revisit_of(world_from_camera(), map_.keyframes[near.front()].submap, false)};
}

std::vector<Revisit> SubmapMapping::take_keyframe(const RgbdFrame& frame) {
  std::vector<std::uint32_t> near = keyframes_near(kNearView_m, kNearView_rad, true);
  near.resize(std::min(near.size(), kNearKeyframes));
  Keyframe keyframe{frame_, layout_.current, submap_from_camera_, detect_features(frame, map_.camera), {}};
  std::vector<Revisit> revisits;
  if (options_.global_bundle_adjustment) revisits = pending_ ? look_again() : recognised(keyframe.features);
  const InsertResult inserted = insert_keyframe(map_, std::move(keyframe), near);
  for (const std::uint32_t landmark : inserted.repeated) index_.add(landmark, map_.landmarks[landmark].descriptor);
  if (revisits.empty() && options_.global_bundle_adjustment && !pending_) revisits = near_inactive();
  return revisits;
}

std::vector<Revisit> SubmapMapping::observe(const RgbdFrame& frame, const Rigid3& world_from_camera) {
  ++frame_;
  submap_from_camera_ = inverse(map_.world_from_submap[layout_.current]) * world_from_camera;
  apply_due();
  close_when_seen();
  choose_submap();
  return is_new_view() ? take_keyframe(frame) : std::vector<Revisit>{};
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
  std::vector<std::uint32_t> submaps;
  for (std::uint32_t submap = 0; submap < graph_.part.size(); ++submap)
    if (graph_.part[submap] == graph_.part[loop.to]) submaps.push_back(submap);
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
  const PendingLoop loop{link, look.overlap, frame_, static_cast<std::int64_t>(map_.keyframes.size()), revisit.by_appearance};
  if (look.overlap >= kSeenWell || (same_part && is_small(drift))) {
    pending_.reset();
    return close(loop);
  }
  if (!pending_ || look.overlap > pending_->overlap) pending_ = loop;
  return true;
}

// What is there of the loop is believed when the camera does not see more of the place.
void SubmapMapping::close_when_seen() {
  if (!pending_) return;
  const auto keyframe = static_cast<std::int64_t>(map_.keyframes.size());
  if (keyframe < pending_->keyframe + kPatientKeyframes && frame_ < pending_->frame + kPatientFrames) return;
  close(*std::exchange(pending_, std::nullopt));
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

void SubmapMapping::found(const Revisit& revisit, const Rigid3& seen_from) {
  ++counts_["found again"];
  go_on_in(nearest_submap(revisit.submaps, seen_from), seen_from);
}

void SubmapMapping::begin_part(const Rigid3& world_from_camera) {
  go_on_in(open_submap(world_from_camera, part_count_++), world_from_camera);
}

void SubmapMapping::publish() {
  layout_.world_from_submap = map_.world_from_submap;
  layout_.part = graph_.part;
}

void SubmapMapping::publish_correction() {
  publish();
  ++layout_.correction_count;
}

void SubmapMapping::adjust_locally() {
  if (running_) return;
  const std::vector<double> way_m = distances_m(graph_, layout_.current);
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t submap = 0; submap < way_m.size(); ++submap)
    if (is_active(submap)) near.emplace_back(way_m[submap], submap);
  std::sort(near.begin(), near.end());
  near.resize(std::min(near.size(), kLocalSubmaps));
  std::vector<std::uint32_t> free;
  for (const auto& [way, submap] : near) free.push_back(submap);
  std::sort(free.begin(), free.end());
  start({bundle_of(map_, graph_, free), map_.world_from_submap.size(), frame_ + kDelayFrames, false});
}

void SubmapMapping::adjust_globally() {
  if (running_) {  // what it would say is of a map that has moved
    running_.reset();
    adjuster_ = std::make_unique<Adjuster>();
  }
  std::vector<std::uint32_t> all;
  for (std::uint32_t submap = 0; submap < graph_.part.size(); ++submap)
    if (graph_.part[submap] == graph_.part[layout_.current]) all.push_back(submap);
  BundleOfMap bundle = bundle_of(map_, graph_, all);
  const auto delay = static_cast<std::int64_t>(bundle.problem.observations.size() / kObservationsPerFrame);
  start({std::move(bundle), map_.world_from_submap.size(), frame_ + kDelayFrames + delay, true});
}

void SubmapMapping::start(Running running) {
  running_ = std::move(running);
  adjuster_->start(running_->bundle.problem, {});
}

void SubmapMapping::apply_due() {
  if (!running_ || (time_ == CorrectionTime::kByFrames && frame_ < running_->due_frame)) return;
  const std::optional<Result<BundleSolution>> ready =
      time_ == CorrectionTime::kByFrames ? std::optional(adjuster_->wait()) : adjuster_->poll();
  if (ready) apply_result(*ready);
}

void SubmapMapping::apply_result(const Result<BundleSolution>& result) {
  const Running done = *std::exchange(running_, std::nullopt);
  if (!result.ok()) {
    ++counts_["failed adjustments"];
    return;
  }
  const std::vector<Rigid3> before = map_.world_from_submap;
  apply(*result, done.bundle.scope, map_);
  // Submaps that came since follow the one they were opened from.
  for (std::size_t submap = done.submap_count; submap < before.size(); ++submap) {
    const std::uint32_t parent = graph_.parent[submap];
    if (parent != submap) map_.world_from_submap[submap] = map_.world_from_submap[parent] * inverse(before[parent]) * before[submap];
  }
  publish_correction();
  ++counts_[done.is_global ? "global adjustments" : "local adjustments"];
}

void SubmapMapping::finish() {
  if (pending_) close(*std::exchange(pending_, std::nullopt));
  if (running_) apply_result(adjuster_->wait());
  // Without a loop there is nothing that dense tracking does not know better than landmarks do (tests/accuracy/README.md).
  const auto closes = [](const SubmapLink& link) { return link.is_loop; };
  if (std::none_of(graph_.links.begin(), graph_.links.end(), closes)) return;
  adjust_globally();
  apply_result(adjuster_->wait());
}

std::map<std::string, std::int64_t> SubmapMapping::counts() const {
  std::map<std::string, std::int64_t> counts = counts_;
  counts["submaps"] = static_cast<std::int64_t>(graph_.part.size());
  counts["keyframes"] = static_cast<std::int64_t>(map_.keyframes.size());
  counts["landmarks"] = static_cast<std::int64_t>(map_.landmarks.size());
  return counts;
}

std::unique_ptr<Mapping> make_mapping(const Camera& camera, const AdjustOptions& options, CorrectionTime time) {
  if (!options.local_bundle_adjustment && !options.global_bundle_adjustment) return nullptr;
  return std::make_unique<SubmapMapping>(rectified(camera), options, time);
}

}  // namespace hermite
