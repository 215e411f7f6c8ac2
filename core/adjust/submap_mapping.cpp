#include "core/adjust/submap_mapping.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/adjust/landmarks.h"
#include "core/adjust/loop_closing.h"
#include "core/adjust/submap_atlas_fields.h"

namespace hermite::adjust {

namespace {

// The landmarks of this many keyframes around the camera are searched in addition to those of the
// last keyframes.
constexpr std::size_t kNearKeyframes = 10;

}  // namespace

SubmapMapping::SubmapMapping(const Camera& camera, const AdjustOptions& options,
                             CorrectionTime time)
    : options_(options), time_(time), atlas_(make_submap_atlas(camera)), adjustment_(time) {}

std::vector<LoopCandidate> SubmapMapping::take_keyframe(const frame::RgbdFrame& frame) {
  SparseMap& map = atlas_.map;
  std::vector<std::uint32_t> near = keyframes_in_view(atlas_, true);
  near.resize(std::min(near.size(), kNearKeyframes));
  Keyframe keyframe{atlas_.frame,
                    atlas_.layout.current,
                    atlas_.submap_from_camera,
                    detect_features(frame, map.camera),
                    {},
                    {}};
  if (options_.depth_links) keyframe.planes = fit_depth_planes(frame.depth, map.camera);
  std::vector<LoopCandidate> candidates;
  if (options_.global_bundle_adjustment)
    candidates = places_.recognised(atlas_, keyframe.features, counts_);
  const auto is_elsewhere = [this](const LoopCandidate& candidate) {
    return is_of_another_component(atlas_, candidate);
  };
  if (loops_.is_pending() && std::none_of(candidates.begin(), candidates.end(), is_elsewhere))
    candidates = loops_.pending_candidate(atlas_);
  const InsertResult inserted = insert_keyframe(map, std::move(keyframe), near);
  places_.add(map, inserted.repeated);
  if (candidates.empty() && options_.global_bundle_adjustment && !loops_.is_pending())
    candidates = places_.near(atlas_);
  return candidates;
}

std::vector<LoopCandidate> SubmapMapping::observe(const frame::RgbdFrame& frame,
                                                  const Rigid3& world_from_camera) {
  ++atlas_.frame;
  atlas_.submap_from_camera =
      inverse(atlas_.map.world_from_submap[atlas_.layout.current]) * world_from_camera;
  adjustment_.apply_due(atlas_, counts_);
  if (const std::optional<VerifiedLoop> due = loops_.take_due(atlas_, counts_)) close(*due);
  if (choose_submap(atlas_, options_) && options_.local_bundle_adjustment)
    adjustment_.start_local(atlas_);
  return is_new_view(atlas_, options_) ? take_keyframe(frame) : std::vector<LoopCandidate>{};
}

bool SubmapMapping::confirm(const LoopCandidate& candidate, const LoopVerification& verified) {
  const LoopDecision::Verdict verdict = loops_.verified(atlas_, candidate, verified);
  if (!verdict.is_possible) ++counts_.impossible_loops;
  return verdict.is_possible && (!verdict.close || close(*verdict.close));
}

// Bends the map so that the loop closes. Returns false, with nothing moved, if it contradicts other
// links.
bool SubmapMapping::close(const VerifiedLoop& loop) {
  const std::optional<ClosedLoop> closed = close_loop(atlas_, loop.link);
  if (!closed) {
    ++counts_.contradicting_loops;
    return false;
  }
  ++(loop.by_appearance ? counts_.loops_by_appearance : counts_.loops_by_nearness);
  if (closed->joins_components) ++counts_.joined_components;
  update_active(atlas_, options_);
  if (closed->has_moved) adjustment_.start_global(atlas_);
  return true;
}

std::vector<LoopCandidate> SubmapMapping::relocalise(const frame::RgbdFrame& frame) {
  if (!options_.global_bundle_adjustment) return {};
  return places_.relocalise(atlas_, detect_features(frame, atlas_.map.camera), counts_);
}

bool SubmapMapping::is_distinctive(const frame::RgbdFrame& frame, const Rigid3& world_from_camera,
                                   std::int64_t known_keyframes) const {
  if (!options_.global_bundle_adjustment) return true;
  return places_.is_distinctive(atlas_.map, detect_features(frame, atlas_.map.camera),
                                world_from_camera, known_keyframes);
}

void SubmapMapping::relocalised(const LoopCandidate& candidate, const Rigid3& seen_from) {
  ++counts_.relocalisations;
  enter_submap(atlas_, nearest_submap(atlas_, candidate.submaps, seen_from), seen_from, options_);
}

void SubmapMapping::begin_component(const Rigid3& world_from_camera, double reach_m) {
  // The camera will not see more of it.
  if (const std::optional<VerifiedLoop> pending = loops_.take()) close(*pending);
  enter_submap(atlas_, open_component(atlas_, world_from_camera, reach_m), world_from_camera,
               options_);
}

void SubmapMapping::finish() {
  if (const std::optional<VerifiedLoop> pending = loops_.take()) close(*pending);
  adjustment_.finish(atlas_, options_.depth_links, counts_);
}

MappingCounts SubmapMapping::counts() const {
  MappingCounts counts = counts_;
  counts.submaps = static_cast<std::int64_t>(atlas_.graph.component.size());
  counts.components = static_cast<std::int64_t>(component_count(atlas_.layout));
  counts.keyframes = static_cast<std::int64_t>(atlas_.map.keyframes.size());
  counts.landmarks = static_cast<std::int64_t>(atlas_.map.landmarks.size());
  return counts;
}

void SubmapMapping::save(ByteWriter& bytes) const {
  bytes.flag(time_ == CorrectionTime::kByFrames);
  adjust::save(bytes, atlas_);
  places_.save(bytes);
  for (const MappingCountName& named : kMappingCountNames) bytes.number(counts_.*named.count);
  loops_.save(bytes);
  adjustment_.save(bytes);
}

void SubmapMapping::restore(ByteReader& bytes) {
  bool by_frames = false;
  bytes.flag(by_frames);
  bytes.require(by_frames == (time_ == CorrectionTime::kByFrames),
                "the state was saved in another mode, live or batch");
  adjust::restore(bytes, atlas_);
  places_.restore(bytes, atlas_.map.landmarks.size());
  for (const MappingCountName& named : kMappingCountNames) bytes.number(counts_.*named.count);
  loops_.restore(bytes, atlas_.map.world_from_submap.size());
  adjustment_.restore(bytes, atlas_);
}

std::unique_ptr<Mapping> make_mapping(const Camera& camera, const AdjustOptions& options,
                                      CorrectionTime time) {
  if (!options.local_bundle_adjustment && !options.global_bundle_adjustment) return nullptr;
  return std::make_unique<SubmapMapping>(rectified(camera), options, time);
}

}  // namespace hermite::adjust
