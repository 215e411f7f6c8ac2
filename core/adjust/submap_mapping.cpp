#include "core/adjust/submap_mapping.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/adjust/depth_links.h"
#include "core/adjust/landmarks.h"

namespace hermite {

namespace {

constexpr double kRadians = M_PI / 180;

// The camera returns to an old submap if it is within this share of the submap's reach. It is well
// below 1 so that the camera does not alternate between two submaps.
constexpr double kBackShare = 0.7;

// Two views this close show much of the same surface.
constexpr double kNearView_m = 1.0, kNearView_rad = 40 * kRadians;

// The landmarks of this many keyframes around the camera are searched in addition to those of the
// last keyframes.
constexpr std::size_t kNearKeyframes = 10;

// A new submap is linked to this many other active submaps besides the previous one.
constexpr std::size_t kTies = 3;

// Local adjustment moves this many submaps around the camera.
constexpr std::size_t kLocalSubmaps = 10;

// Rounds of alignment by depth: the first starts from the landmarks' result, each other one from
// the last. A fourth round moves submaps by hundredths of a millimetre.
constexpr int kDepthRounds = 3;

// The result of an adjustment is due after this many frames, plus one for so many observations: a
// core adjusts 46 of them per millisecond (148,000 in 3.2 s), and at 30 Hz a frame leaves it 33 ms.
constexpr std::int64_t kDelayFrames = 5;
constexpr std::size_t kObservationsPerFrame = 2000;

}  // namespace

SubmapMapping::SubmapMapping(const Camera& camera, const AdjustOptions& options, CorrectionTime time)
    : options_(options), time_(time), adjuster_(std::make_unique<Adjuster>()) {
  map_.camera = camera;
  map_.world_from_submap = layout_.world_from_submap;
  add_submap(graph_, 0);
}

std::uint32_t SubmapMapping::open_submap(const Rigid3& world_from_submap, std::uint32_t component) {
  map_.world_from_submap.push_back(world_from_submap);
  layout_.is_active.push_back(true);
  const std::uint32_t submap = add_submap(graph_, component);
  publish();
  return submap;
}

// Marks the submaps that the camera is tracked against: those within a path so short that tracking
// has not drifted.
void SubmapMapping::update_active() {
  const std::vector<double> way_m = distances_m(graph_, layout_.current);
  for (std::size_t submap = 0; submap < way_m.size(); ++submap) {
    const bool same_component = graph_.component[submap] == graph_.component[layout_.current];
    layout_.is_active[submap] = options_.global_bundle_adjustment ? way_m[submap] <= options_.active_path_m : same_component;
  }
}

void SubmapMapping::go_on_in(std::uint32_t submap, const Rigid3& world_from_camera) {
  layout_.current = submap;
  submap_from_camera_ = inverse(map_.world_from_submap[submap]) * world_from_camera;
  update_active();
}

// When the camera leaves the reach of the current submap, it continues in an existing one or opens
// a new one.
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
  const std::uint32_t submap = opens ? open_submap(camera, graph_.component[before]) : back->second;
  if (opens) graph_.parent[submap] = before;
  const auto tie = [&](std::uint32_t other) {
    if (other != submap) link_tracked(graph_, other, submap, inverse(map_.world_from_submap[other]) * map_.world_from_submap[submap]);
  };
  tie(before);
  for (std::size_t i = 0; i < std::min(near.size(), kTies); ++i) tie(near[i].second);
  go_on_in(submap, camera);
  if (opens && options_.local_bundle_adjustment) adjust_locally();
}

std::vector<std::uint32_t> SubmapMapping::submaps_of(std::uint32_t component) const {
  std::vector<std::uint32_t> submaps;
  for (std::uint32_t submap = 0; submap < graph_.component.size(); ++submap)
    if (graph_.component[submap] == component) submaps.push_back(submap);
  return submaps;
}

// Returns keyframes near the camera, nearest first: those in active submaps of this component, or
// those in inactive ones.
std::vector<std::uint32_t> SubmapMapping::keyframes_near(double distance_m, double turn_rad, bool active) const {
  const Rigid3 camera_from_world = inverse(world_from_camera());
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t i = 0; i < map_.keyframes.size(); ++i) {
    const std::uint32_t submap = map_.keyframes[i].submap;
    if (is_active(submap) != active || graph_.component[submap] != graph_.component[layout_.current]) continue;
    const Rigid3 camera_from_keyframe = camera_from_world * hermite::world_from_camera(map_, map_.keyframes[i]);
    if (is_within(camera_from_keyframe, distance_m, turn_rad)) near.emplace_back(length_of(camera_from_keyframe), i);
  }
  std::sort(near.begin(), near.end());
  std::vector<std::uint32_t> keyframes;
  for (const auto& [length, keyframe] : near) keyframes.push_back(keyframe);
  return keyframes;
}

std::vector<std::uint32_t> SubmapMapping::keyframes_in_view(bool active) const {
  return keyframes_near(kNearView_m, kNearView_rad, active);
}

bool SubmapMapping::is_new_view() const {
  return keyframes_near(options_.keyframe_distance_m, options_.keyframe_turn_deg * kRadians, true).empty();
}

std::vector<LoopCandidate> SubmapMapping::take_keyframe(const RgbdFrame& frame) {
  std::vector<std::uint32_t> near = keyframes_in_view(true);
  near.resize(std::min(near.size(), kNearKeyframes));
  Keyframe keyframe{frame_, layout_.current, submap_from_camera_, detect_features(frame, map_.camera), {}, {}};
  if (options_.depth_links) keyframe.planes = fit_depth_planes(frame.depth, map_.camera);
  std::vector<LoopCandidate> candidates;
  if (options_.global_bundle_adjustment) candidates = recognised(keyframe.features);
  if (pending_ && std::none_of(candidates.begin(), candidates.end(), [this](const LoopCandidate& c) { return is_of_another_component(c); }))
    candidates = pending_candidate();
  const InsertResult inserted = insert_keyframe(map_, std::move(keyframe), near);
  for (const std::uint32_t landmark : inserted.repeated) index_.add(landmark, map_.landmarks[landmark].descriptor);
  if (candidates.empty() && options_.global_bundle_adjustment && !pending_) candidates = near_inactive();
  return candidates;
}

std::vector<LoopCandidate> SubmapMapping::observe(const RgbdFrame& frame, const Rigid3& world_from_camera) {
  ++frame_;
  submap_from_camera_ = inverse(map_.world_from_submap[layout_.current]) * world_from_camera;
  apply_due();
  close_when_seen();
  choose_submap();
  return is_new_view() ? take_keyframe(frame) : std::vector<LoopCandidate>{};
}

void SubmapMapping::relocalised(const LoopCandidate& candidate, const Rigid3& seen_from) {
  ++counts_.relocalisations;
  go_on_in(nearest_submap(candidate.submaps, seen_from), seen_from);
}

void SubmapMapping::begin_component(const Rigid3& world_from_camera) {
  if (pending_) close(*std::exchange(pending_, std::nullopt));  // the camera will not see more of it
  go_on_in(open_submap(world_from_camera, component_count_++), world_from_camera);
}

void SubmapMapping::publish() {
  layout_.world_from_submap = map_.world_from_submap;
  layout_.component = graph_.component;
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
  start({bundle_of(map_, graph_, free), map_.world_from_submap.size(), frame_ + kDelayFrames, false, {}});
}

// An adjustment that is running for loops continues; otherwise a camera that closes one loop after
// the other would never get a result. The next adjustment covers all loops closed by then.
void SubmapMapping::adjust_globally() {
  if (running_ && running_->is_global) {
    running_->loop_since = layout_.current;
    return;
  }
  if (running_) give_up();
  start(global_adjustment(graph_.component[layout_.current]));
}

SubmapMapping::Running SubmapMapping::global_adjustment(std::uint32_t component) const {
  BundleOfMap bundle = bundle_of(map_, graph_, submaps_of(component));
  const auto delay = static_cast<std::int64_t>(bundle.problem.observations.size() / kObservationsPerFrame);
  return {std::move(bundle), map_.world_from_submap.size(), frame_ + kDelayFrames + delay, true, {}};
}

void SubmapMapping::give_up() {
  running_.reset();
  adjuster_ = std::make_unique<Adjuster>();
}

void SubmapMapping::start(Running running) {
  running_ = std::move(running);
  adjuster_->start(running_->bundle.problem, {});
}

void SubmapMapping::apply_due() {
  if (!running_ || (time_ == CorrectionTime::kByFrames && frame_ < running_->due_frame)) return;
  const std::optional<Result<BundleSolution>> ready =
      time_ == CorrectionTime::kByFrames ? std::optional(adjuster_->wait()) : adjuster_->poll();
  if (!ready) return;
  // The next problem is taken from the map before this result is applied, bent by loops alone:
  // bundle_of() estimates the accuracy of tracking from it.
  std::optional<Running> next;
  if (running_->loop_since) next = global_adjustment(graph_.component[*running_->loop_since]);
  apply_result(*ready);
  if (next) start(*std::move(next));
}

void SubmapMapping::apply_result(const Result<BundleSolution>& result) {
  const Running done = *std::exchange(running_, std::nullopt);
  if (!result.ok()) {
    ++counts_.failed_adjustments;
    return;
  }
  const std::vector<Rigid3> before = map_.world_from_submap;
  apply(*result, done.bundle.scope, map_);
  // Loops closed since the adjustment began have bent the map; the same motion is applied to the
  // result.
  for (std::size_t i = 0; done.loop_since && i < done.bundle.scope.submaps.size(); ++i) {
    const std::uint32_t submap = done.bundle.scope.submaps[i];
    const Rigid3 bent = before[submap] * inverse(done.bundle.problem.world_from_submap[i]);
    map_.world_from_submap[submap] = bent * map_.world_from_submap[submap];
  }
  // Submaps opened since then follow the submap they were opened from.
  for (std::size_t submap = done.submap_count; submap < before.size(); ++submap) {
    const std::uint32_t parent = graph_.parent[submap];
    if (parent != submap) map_.world_from_submap[submap] = map_.world_from_submap[parent] * inverse(before[parent]) * before[submap];
  }
  publish_correction();
  ++(done.is_global ? counts_.global_adjustments : counts_.local_adjustments);
}

void SubmapMapping::finish() {
  if (pending_) close(*std::exchange(pending_, std::nullopt));
  if (running_ && running_->loop_since) give_up();  // the adjustment below replaces it
  if (running_) apply_result(adjuster_->wait());
  // Without a loop, dense tracking is more accurate than landmarks (tests/accuracy/LAB.md).
  const auto closes = [](const SubmapLink& link) { return link.is_loop; };
  if (std::none_of(graph_.links.begin(), graph_.links.end(), closes)) return;
  const std::vector<std::uint32_t> submaps = submaps_of(graph_.component[layout_.current]);
  const BundleOfMap bundle = pose_graph_of(map_, graph_, submaps, submaps.front());
  if (const Result<BundleSolution> bent = adjust(bundle.problem, {}); bent.ok()) apply(*bent, bundle.scope, map_);
  adjust_globally();
  apply_result(adjuster_->wait());
  if (options_.depth_links) straighten(submaps);
}

// Aligns submaps by depth, from where loops and landmarks have placed them.
void SubmapMapping::straighten(const std::vector<std::uint32_t>& submaps) {
  for (int round = 0; round < kDepthRounds; ++round) {
    BundleOfMap bundle = bundle_of(map_, graph_, submaps);
    for (BundleLink& link : depth_links(map_, submaps)) bundle.problem.links.push_back(std::move(link));
    const Result<BundleSolution> straight = adjust(bundle.problem, {});
    if (straight.ok()) apply(*straight, bundle.scope, map_);
    if (!straight.ok()) ++counts_.failed_adjustments;
  }
  publish_correction();
}

MappingCounts SubmapMapping::counts() const {
  MappingCounts counts = counts_;
  counts.submaps = static_cast<std::int64_t>(graph_.component.size());
  counts.components = static_cast<std::int64_t>(component_count(layout_));
  counts.keyframes = static_cast<std::int64_t>(map_.keyframes.size());
  counts.landmarks = static_cast<std::int64_t>(map_.landmarks.size());
  return counts;
}

std::unique_ptr<Mapping> make_mapping(const Camera& camera, const AdjustOptions& options, CorrectionTime time) {
  if (!options.local_bundle_adjustment && !options.global_bundle_adjustment) return nullptr;
  return std::make_unique<SubmapMapping>(rectified(camera), options, time);
}

}  // namespace hermite
