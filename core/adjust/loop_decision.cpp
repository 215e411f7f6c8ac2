#include "core/adjust/loop_decision.h"

#include <utility>

#include "core/adjust/loop_closing.h"
#include "core/adjust/submap_fields.h"

namespace hermite::adjust {

namespace {

// A verification with at least this overlap closes the loop at once. With less, it is repeated at
// every keyframe until the overlap has not grown for kPatientKeyframes keyframes or kPatientFrames
// frames. When the camera came back to a place along a corridor, an alignment with an overlap of 31
// % was off by 5.8 mm, with 41 % by 2.8, with 54 % by 1.4, and from 60 % on by 0.4 to 1
// (tests/accuracy/LAB.md).
constexpr double kSeenWell = 0.6;
constexpr std::int64_t kPatientKeyframes = 3, kPatientFrames = 45;
constexpr std::uint32_t kMostVerifications = 15;

template <class Bytes, class Saved>
void verified_loop_fields(Bytes& bytes, Saved& loop) {
  link_fields(bytes, loop.link);
  bytes.number(loop.overlap);
  bytes.number(loop.frame);
  bytes.number(loop.keyframe);
  bytes.flag(loop.by_appearance);
  bytes.number(loop.later_verifications);
  bytes.require(loop.overlap >= 0 && loop.overlap <= 1 && is_stored_index(loop.frame) &&
                    is_stored_index(loop.keyframe),
                "the pending loop is invalid");
}

}  // namespace

LoopDecision::Verdict LoopDecision::verified(const SubmapAtlas& atlas,
                                             const LoopCandidate& candidate,
                                             const LoopVerification& verification) {
  const std::uint32_t current = atlas.layout.current;
  const std::uint32_t target =
      nearest_submap(atlas, candidate.submaps, verification.world_from_camera);
  const bool same_component = atlas.graph.component[target] == atlas.graph.component[current];
  const Rigid3 drift = inverse(world_from_camera(atlas)) * verification.world_from_camera;
  if (same_component && !is_possible_drift(drift, distances_m(atlas.graph, current)[target]))
    return {false, {}};
  const Rigid3 target_from_camera =
      inverse(atlas.map.world_from_submap[target]) * verification.world_from_camera;
  const SubmapLink link{current, target, atlas.submap_from_camera * inverse(target_from_camera), 0,
                        true};
  const auto keyframe = static_cast<std::int64_t>(atlas.map.keyframes.size());
  const VerifiedLoop loop{
      link,     verification.overlap,    atlas.frame,
      keyframe, candidate.by_appearance, pending_ ? pending_->later_verifications + 1 : 0};
  // Components are joined at once, because it is unknown how long a camera in a new component will
  // see the old one.
  if (verification.overlap >= kSeenWell || !same_component || is_small_correction(drift)) {
    pending_.reset();
    return {true, loop};
  }
  if (!pending_ || verification.overlap > pending_->overlap) pending_ = loop;
  pending_->later_verifications = loop.later_verifications;
  return {true, {}};
}

std::vector<LoopCandidate> LoopDecision::pending_candidate(const SubmapAtlas& atlas) const {
  const SubmapLink& loop = pending_->link;
  if (atlas.graph.component[loop.from] != atlas.graph.component[atlas.layout.current]) return {};
  const Rigid3 from_from_camera =
      inverse(atlas.map.world_from_submap[loop.from]) * world_from_camera(atlas);
  return {candidate_at(atlas, placed_by(atlas.map, loop) * from_from_camera, loop.to,
                       pending_->by_appearance)};
}

std::optional<VerifiedLoop> LoopDecision::take_due(const SubmapAtlas& atlas,
                                                   MappingCounts& counts) {
  if (!pending_) return std::nullopt;
  const bool was_verified_again = static_cast<std::int64_t>(atlas.map.keyframes.size()) >=
                                      pending_->keyframe + kPatientKeyframes ||
                                  pending_->later_verifications >= kMostVerifications;
  if (!was_verified_again && atlas.frame < pending_->frame + kPatientFrames) return std::nullopt;
  const VerifiedLoop loop = *take();
  if (!was_verified_again || loop.later_verifications > 0) return loop;
  ++counts.unrepeated_loops;
  return std::nullopt;
}

std::optional<VerifiedLoop> LoopDecision::take() { return std::exchange(pending_, std::nullopt); }

void LoopDecision::save(ByteWriter& bytes) const {
  bytes.flag(is_pending());
  if (pending_) verified_loop_fields(bytes, *pending_);
}

void LoopDecision::restore(ByteReader& bytes, std::size_t submap_count) {
  bool is_pending = false;
  bytes.flag(is_pending);
  if (!is_pending) return;
  VerifiedLoop loop;
  verified_loop_fields(bytes, loop);
  bytes.require(loop.link.from < submap_count && loop.link.to < submap_count,
                "the ends of the pending loop are out of range");
  pending_ = loop;
}

}  // namespace hermite::adjust
