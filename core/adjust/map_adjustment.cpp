#include "core/adjust/map_adjustment.h"

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/adjust/bundle_fields.h"
#include "core/adjust/depth_links.h"
#include "core/adjust/submap_fields.h"

namespace hermite::adjust {

namespace {

// Local adjustment moves this many submaps around the camera.
constexpr std::size_t kLocalSubmaps = 10;

// Rounds of alignment by depth: the first starts from the landmarks' result, each other one from
// the last. A fourth round moves submaps by hundredths of a millimetre.
constexpr int kDepthRounds = 3;

// The result of an adjustment is due after this many frames, plus one for so many observations: a
// core adjusts 46 of them per millisecond (148,000 in 3.2 s), and at 30 Hz a frame leaves it 33 ms.
constexpr std::int64_t kDelayFrames = 5;
constexpr std::size_t kObservationsPerFrame = 2000;

// Aligns submaps by depth, from where loops and landmarks have placed them.
void straighten(SubmapAtlas& atlas, const std::vector<std::uint32_t>& submaps,
                MappingCounts& counts) {
  for (int round = 0; round < kDepthRounds; ++round) {
    BundleOfMap bundle = bundle_of(atlas.map, atlas.graph, submaps);
    for (BundleLink& link : depth_links(atlas.map, submaps))
      bundle.problem.links.push_back(std::move(link));
    const Result<BundleSolution> straight = adjust(bundle.problem, {});
    if (straight.ok()) apply(*straight, bundle.scope, atlas.map);
    if (!straight.ok()) ++counts.failed_adjustments;
  }
  publish_correction(atlas);
}

}  // namespace

MapAdjustment::MapAdjustment(CorrectionTime time)
    : time_(time), adjuster_(std::make_unique<Adjuster>()) {}

void MapAdjustment::start_local(const SubmapAtlas& atlas) {
  if (running_) return;
  const std::vector<double> way_m = distances_m(atlas.graph, atlas.layout.current);
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t submap = 0; submap < way_m.size(); ++submap)
    if (atlas.layout.is_active[submap]) near.emplace_back(way_m[submap], submap);
  std::sort(near.begin(), near.end());
  near.resize(std::min(near.size(), kLocalSubmaps));
  std::vector<std::uint32_t> free;
  for (const auto& [way, submap] : near) free.push_back(submap);
  std::sort(free.begin(), free.end());
  start({bundle_of(atlas.map, atlas.graph, free),
         atlas.map.world_from_submap.size(),
         atlas.frame + kDelayFrames,
         false,
         {}});
}

// An adjustment that is running for loops continues; otherwise a camera that closes one loop after
// the other would never get a result. The next adjustment covers all loops closed by then.
void MapAdjustment::start_global(const SubmapAtlas& atlas) {
  const std::uint32_t current = atlas.layout.current;
  if (running_ && running_->is_global) {
    running_->loop_since = current;
    return;
  }
  if (running_) give_up();
  start(global_adjustment(atlas, atlas.graph.component[current]));
}

MapAdjustment::Running MapAdjustment::global_adjustment(const SubmapAtlas& atlas,
                                                        std::uint32_t component) {
  BundleOfMap bundle = bundle_of(atlas.map, atlas.graph, submaps_of(atlas.graph, component));
  const auto delay =
      static_cast<std::int64_t>(bundle.problem.observations.size() / kObservationsPerFrame);
  return {std::move(bundle),
          atlas.map.world_from_submap.size(),
          atlas.frame + kDelayFrames + delay,
          true,
          {}};
}

void MapAdjustment::give_up() {
  running_.reset();
  adjuster_ = std::make_unique<Adjuster>();
}

void MapAdjustment::start(Running running) {
  running_ = std::move(running);
  adjuster_->start(running_->bundle.problem, {});
}

void MapAdjustment::apply_due(SubmapAtlas& atlas, MappingCounts& counts) {
  if (!running_ || (time_ == CorrectionTime::kByFrames && atlas.frame < running_->due_frame))
    return;
  const std::optional<Result<BundleSolution>> ready =
      time_ == CorrectionTime::kByFrames ? std::optional(adjuster_->wait()) : adjuster_->poll();
  if (!ready) return;
  // The next problem is taken from the map before this result is applied, bent by loops alone:
  // bundle_of() estimates the accuracy of tracking from it.
  std::optional<Running> next;
  if (running_->loop_since)
    next = global_adjustment(atlas, atlas.graph.component[*running_->loop_since]);
  apply_result(*ready, atlas, counts);
  if (next) start(*std::move(next));
}

void MapAdjustment::apply_result(const Result<BundleSolution>& result, SubmapAtlas& atlas,
                                 MappingCounts& counts) {
  const Running done = *std::exchange(running_, std::nullopt);
  if (!result.ok()) {
    ++counts.failed_adjustments;
    return;
  }
  std::vector<Rigid3>& world_from_submap = atlas.map.world_from_submap;
  const std::vector<Rigid3> before = world_from_submap;
  apply(*result, done.bundle.scope, atlas.map);
  // Loops closed since the adjustment began have bent the map; the same motion is applied to the
  // result.
  for (std::size_t i = 0; done.loop_since && i < done.bundle.scope.submaps.size(); ++i) {
    const std::uint32_t submap = done.bundle.scope.submaps[i];
    const Rigid3 bent = before[submap] * inverse(done.bundle.problem.world_from_submap[i]);
    world_from_submap[submap] = bent * world_from_submap[submap];
  }
  // Submaps opened since then follow the submap they were opened from.
  for (std::size_t submap = done.submap_count; submap < before.size(); ++submap) {
    const std::uint32_t parent = atlas.graph.parent[submap];
    if (parent != submap)
      world_from_submap[submap] =
          world_from_submap[parent] * inverse(before[parent]) * before[submap];
  }
  publish_correction(atlas);
  ++(done.is_global ? counts.global_adjustments : counts.local_adjustments);
}

void MapAdjustment::finish(SubmapAtlas& atlas, bool by_depth, MappingCounts& counts) {
  if (running_ && running_->loop_since) give_up();  // the adjustment below replaces it
  if (running_) apply_result(adjuster_->wait(), atlas, counts);
  // Without a loop, dense tracking is more accurate than landmarks (tests/accuracy/LAB.md).
  const auto closes = [](const SubmapLink& link) { return link.is_loop; };
  if (std::none_of(atlas.graph.links.begin(), atlas.graph.links.end(), closes)) return;
  const std::vector<std::uint32_t> submaps =
      submaps_of(atlas.graph, atlas.graph.component[atlas.layout.current]);
  const BundleOfMap bundle = pose_graph_of(atlas.map, atlas.graph, submaps, submaps.front());
  if (const Result<BundleSolution> bent = adjust(bundle.problem, {}); bent.ok())
    apply(*bent, bundle.scope, atlas.map);
  start_global(atlas);
  apply_result(adjuster_->wait(), atlas, counts);
  if (by_depth) straighten(atlas, submaps, counts);
}

template <class Bytes, class Saved>
void MapAdjustment::running_fields(Bytes& bytes, Saved& running) {
  bundle_fields(bytes, running.bundle);
  bytes.number(running.submap_count);
  bytes.number(running.due_frame);
  bytes.flag(running.is_global);
  bool is_bent = running.loop_since.has_value();
  bytes.flag(is_bent);
  std::uint32_t loop_since = running.loop_since.value_or(0);
  if (is_bent) bytes.number(loop_since);
  if constexpr (!std::is_const_v<Saved>)
    running.loop_since = is_bent ? std::optional(loop_since) : std::nullopt;
}

void MapAdjustment::save(ByteWriter& bytes) const {
  bytes.flag(running_.has_value());
  if (running_) running_fields(bytes, *running_);
}

void MapAdjustment::restore(ByteReader& bytes, const SubmapAtlas& atlas) {
  bool is_running = false;
  bytes.flag(is_running);
  if (!is_running) return;
  Running running;
  running_fields(bytes, running);
  const std::size_t submaps = atlas.map.world_from_submap.size();
  check_scope(bytes, running.bundle, atlas.map);
  bytes.require(running.submap_count <= submaps,
                "the number of submaps of a running adjustment is out of range");
  bytes.require(!running.loop_since || *running.loop_since < submaps,
                "the submap of a closed loop is out of range");
  bytes.require(is_stored_index(running.due_frame),
                "the frame at which an adjustment is due is out of range");
  if (!bytes.ok()) return;
  running.bundle.problem.camera = atlas.map.camera;
  start(std::move(running));
}

}  // namespace hermite::adjust
