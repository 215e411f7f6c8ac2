#include "tests/accuracy/program/place_audit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hermite {

namespace {

constexpr double kRadians = M_PI / 180;

// Such a view has most of its image in common with another.
constexpr double kNear_m = 1.0, kNear_deg = 40.0;

// Of a lost camera: a hand's breadth apart at these walks.
constexpr std::int64_t kFramesPerQuestion = 3;

bool is_within(const Rigid3& a_from_b, double distance_m, double turn_deg) {
  return a_from_b.translation.norm() < distance_m &&
         angle_rad(a_from_b.rotation) < turn_deg * kRadians;
}

}  // namespace

PlaceAudit::PlaceAudit(std::unique_ptr<adjust::Mapping> mapping, const dataset::Trajectory& truth,
                       PlaceQuestion question, std::int64_t lap_frames)
    : mapping_(std::move(mapping)), truth_(truth), question_(question), lap_frames_(lap_frames) {}

const PlaceCounts& PlaceAudit::result() {
  if (std::exchange(answered_right_, false) && asked_at_known_) ++counts_.right;
  asked_at_known_ = false;
  return counts_;
}

// Does a keyframe of an inactive submap show this view?
bool PlaceAudit::knows(const Rigid3& true_pose) const {
  return std::any_of(views_.begin(), views_.end(), [&](const View& view) {
    return view.submap < lap_submaps_ && !layout().is_active[view.submap] &&
           is_within(inverse(view.true_pose) * true_pose, kNear_m, kNear_deg);
  });
}

void PlaceAudit::show_first_lap_only(std::vector<adjust::LoopCandidate>& candidates) const {
  for (adjust::LoopCandidate& candidate : candidates)
    for (std::size_t submap = lap_submaps_; submap < candidate.submaps.size(); ++submap)
      candidate.submaps[submap] = false;
  std::erase_if(candidates, [](const adjust::LoopCandidate& candidate) {
    return std::count(candidate.submaps.begin(), candidate.submaps.end(), true) == 0;
  });
}

std::vector<adjust::LoopCandidate> PlaceAudit::ask_about_loop(const frame::RgbdFrame& frame,
                                                              const Rigid3& world_from_camera) {
  const auto keyframe_count = [this] { return mapping_->counts().keyframes; };
  const std::int64_t before = keyframe_count();
  std::vector<adjust::LoopCandidate> candidates = mapping_->observe(frame, world_from_camera);
  if (keyframe_count() == before) return candidates;
  asked_at_known_ = question_ == PlaceQuestion::kLoop && knows(true_pose_);
  views_.push_back({true_pose_, world_from_camera, layout().current});
  show_first_lap_only(candidates);
  return candidates;
}

std::vector<adjust::LoopCandidate> PlaceAudit::ask_lost(const frame::RgbdFrame& frame) {
  if (frame_ % kFramesPerQuestion != 0) return {};
  asked_at_known_ = std::any_of(views_.begin(), views_.end(), [&](const View& view) {
    return is_within(inverse(view.true_pose) * true_pose_, kNear_m, kNear_deg);
  });
  std::vector<adjust::LoopCandidate> candidates = mapping_->relocalise(frame);
  // Into which this lap is fused.
  for (adjust::LoopCandidate& candidate : candidates) candidate.submaps[layout().current] = false;
  show_first_lap_only(candidates);
  return candidates;
}

std::vector<adjust::LoopCandidate> PlaceAudit::observe(const frame::RgbdFrame& frame,
                                                       const Rigid3& world_from_camera) {
  result();
  ++frame_;
  if (frame_ < lap_frames_) lap_submaps_ = layout().is_active.size();
  const std::optional<Rigid3> pose = dataset::pose_at(truth_, frame.timestamp_s, 1e-3);
  if (!pose) return {};
  true_pose_ = inverse(truth_.front().world_from_camera) * *pose;
  const bool is_frozen = question_ == PlaceQuestion::kLost && frame_ >= lap_frames_;
  std::vector<adjust::LoopCandidate> candidates =
      is_frozen ? ask_lost(frame) : ask_about_loop(frame, world_from_camera);
  if (question_ == PlaceQuestion::kLost && !is_frozen) return {};
  counts_.known += asked_at_known_ ? 1 : 0;
  counts_.unguessed += asked_at_known_ && candidates.empty() ? 1 : 0;
  return candidates;
}

bool PlaceAudit::is_right(const adjust::LoopCandidate& candidate, const Rigid3& seen_from) const {
  const View* nearest = nullptr;
  double least_m = kNear_m;
  for (const View& view : views_) {
    const Rigid3 view_from_camera = inverse(view.true_pose) * true_pose_;
    if (!candidate.submaps[view.submap] || !is_within(view_from_camera, least_m, kNear_deg))
      continue;
    nearest = &view;
    least_m = view_from_camera.translation.norm();
  }
  if (nearest == nullptr) return false;
  const Rigid3 expected = nearest->mapped_pose * inverse(nearest->true_pose) * true_pose_;
  return is_within(inverse(expected) * seen_from, kRight_m, kRight_deg);
}

bool PlaceAudit::confirm(const adjust::LoopCandidate& candidate,
                         const adjust::LoopVerification& verified) {
  if (is_right(candidate, verified.world_from_camera))
    answered_right_ = true;
  else
    ++counts_.wrong;
  return false;
}

}  // namespace hermite
