#include "core/pipeline/reconstruction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/math/rigid3_fields.h"

namespace hermite::pipeline {

namespace {

// Returns the judgement of a frame that added nothing because the map is full.
track::Judgement of_full_map(track::Judgement tracked) {
  tracked.status = track::TrackingStatus::kWeak;
  tracked.reason +=
      (tracked.reason.empty() ? "" : "; ") +
      std::string("the map is full: the allowed device memory has no room for new surface");
  return tracked;
}

// A tenth of the distance from which something counts as moved (core/track/moving_regions.cpp).
constexpr double kCorrectionThatMovesViews_m = 0.003;

// A lost camera's last place is known to this many of its stated standard deviations.
constexpr double kReachDeviations = 3;

// Of an incomplete depth image at least half is processed: where every third frame of a rendered
// room was torn at a random row, the path was 2.9 mm off, and 3.3 without the use of any part;
// 14 mm where strips of some rows were tracked as well, and 2.3 mm if no frame was torn. But no
// longer than this are frames left out for it.
constexpr double kMostRepeatedRows = 0.5, kLongestCoast_s = 0.1;

// Standard deviation of the moment at which an image is taken, relative to its stamp: rows of a
// rolling shutter are taken over up to 33 ms, their mean up to 16 ms late, which is within 3.3 of
// these. The camera watch does not find it in slow motion.
constexpr double kStampDeviation_s = 0.005;

void describe_motion(const Motion& motion, FrameResult& result) {
  result.status = motion.judgement.status;
  result.reason = motion.judgement.reason;
  result.inlier_count = motion.odometry.inlier_count;
  result.inlier_ratio = motion.odometry.inlier_ratio;
  result.residual_rms_m = motion.odometry.residual_rms_m;
}

double farthest_correction_m(const std::vector<Rigid3>& before, const adjust::MapLayout& layout) {
  double farthest_m = 0;
  for (std::size_t submap = 0; submap < before.size(); ++submap)
    if (layout.is_active[submap])
      farthest_m = std::max(
          farthest_m,
          (layout.world_from_submap[submap].translation - before[submap].translation).norm());
  return farthest_m;
}

}  // namespace

// Passes a tracked frame to the back end, which may open and move submaps and close loops.
MapEvent Reconstruction::observe(const frame::RgbdFrame& frame, const Rigid3& tracked) {
  const std::uint32_t submap = layout().current;
  const Rigid3 submap_from_camera = inverse(layout().world_from_submap[submap]) * tracked;
  const std::size_t components_before = adjust::component_count(layout());
  const std::uint64_t closures_before = layout().closure_count;
  const std::optional<frame::RgbdFrame> rest = front_end.without_moving(frame);
  for (const adjust::LoopCandidate& candidate : mapping->observe(rest ? *rest : frame, tracked)) {
    const std::optional<adjust::LoopVerification> verified = front_end.verify(candidate, layout());
    // The other candidates refer to the layout before this correction.
    if (verified && mapping->confirm(candidate, *verified)) break;
  }
  world_from_camera = layout().world_from_submap[submap] * submap_from_camera;
  if (adjust::component_count(layout()) < components_before) return MapEvent::kJoined;
  return layout().closure_count > closures_before ? MapEvent::kLoopClosed : MapEvent::kNone;
}

// Returns how far the camera can have come [m]: infinitely when the clock was set back.
double Reconstruction::reach_m(double timestamp_s) const {
  if (timestamp_s <= pace.last_tracked_s()) return std::numeric_limits<double>::infinity();
  return track::PlaceDoubt::reach_m(unseen_s(timestamp_s)) +
         kReachDeviations * uncertainty.position_sigma_m();
}

// Returns how far the candidate's place is from the camera's last one [m]; 0 in another component
// of the map, where this is not known.
double Reconstruction::jump_m(const adjust::LoopCandidate& candidate,
                              const adjust::LoopVerification& verified) const {
  const auto submap = static_cast<std::size_t>(std::ranges::find(candidate.submaps, true) -
                                               candidate.submaps.begin());
  if (submap < candidate.submaps.size() &&
      layout().component[submap] != layout().component[layout().current])
    return 0;
  return (verified.world_from_camera.translation - world_from_camera.translation).norm();
}

// Relocalises a lost camera, or continues the map in a new component.
MapEvent Reconstruction::relocalise(const frame::PreparedFrame& prepared, track::SightGap& gap,
                                    Motion& motion) {
  const std::vector<adjust::LoopCandidate> candidates = mapping->relocalise(prepared.frame);
  for (const adjust::LoopCandidate& candidate : candidates) {
    const std::optional<adjust::LoopVerification> verified = front_end.verify(candidate, layout());
    if (!verified) continue;
    const double jump = jump_m(candidate, *verified);
    if (jump > reach_m(prepared.frame.timestamp_s)) continue;
    gap.jump_m = jump;
    mapping->relocalised(candidate, verified->world_from_camera);
    world_from_camera = verified->world_from_camera;
    front_end.corners.forget_points();
    motion = {{}, {track::TrackingStatus::kWeak, "found again"}};
    return MapEvent::kFoundAgain;
  }
  if (front_end.judge_start(prepared.content).status != track::TrackingStatus::kLost)
    ++unplaced_count;
  if (unplaced_count >= options.adjust.new_part_after_frames) {
    mapping->begin_component(world_from_camera, reach_m(prepared.frame.timestamp_s));
    front_end.corners.forget_points();
    motion = {
        {},
        {track::TrackingStatus::kWeak,
         "not relocalised: a new part of the map begins and is joined when the camera sees both"}};
    return MapEvent::kNewPart;
  }
  // Verification has overwritten the prediction.
  if (!candidates.empty()) front_end.predict(world_from_camera, layout());
  return MapEvent::kNone;
}

// Computes the uncertainty of the frame's pose and lowers its status if that is too large.
void Reconstruction::judge_uncertainty(const frame::RgbdFrame& frame, const track::SightGap& gap,
                                       Motion& motion, FrameResult& result) {
  track::MapCertainty& certainty = front_end.certainty();
  if (result.event == MapEvent::kNewPart) certainty.begin_component(ground_of(layout()));
  track::MapCertainty::StepError error{.timestamp_s = result.timestamp_s, .gap = gap};
  if (mapping && certainty.is_in_doubt(gap))
    error.is_distinctive = mapping->is_distinctive(frame, world_from_camera, known_keyframes);
  uncertainty = track::with_error(
      front_end.uncertainty_at(world_from_camera, motion.odometry, error, layout()),
      kStampDeviation_s * adjoint(world_from_camera) * pace.twist_per_s(),
      world_from_camera.translation);
  result.uncertainty = uncertainty;
  motion.judgement = track::weighed(std::move(motion.judgement),
                                    {uncertainty, front_end.calibration_doubt(),
                                     track::contradiction(motion.odometry.witnesses)});
}

// Returns whether the depth image repeats the last one, or most of it: noise makes two measurements
// differ, so the driver has delivered it again. A lost camera processes it anyway, and so does one
// that has not seen a better frame for long.
bool Reconstruction::is_repeated(const frame::PreparedFrame& taken) const {
  const std::uint64_t digest = taken.content.depth_digest;
  const bool is_most_repeated = taken.repeated_share > kMostRepeatedRows &&
                                unseen_s(taken.frame.timestamp_s) < kLongestCoast_s;
  return lost_count == 0 && tracked_frame_count > 0 &&
         ((digest != 0 && digest == last_depth_digest) || is_most_repeated);
}

// Lets the camera go on as it went, for a depth image of which this share of the rows, or else all,
// is repeated. Returns the motion since the last tracked frame.
Rigid3 Reconstruction::coast(double repeated_share, FrameResult& result) {
  const CoastedMotion coasted = pace.coasted(result.timestamp_s);
  track::PoseUncertainty here = uncertainty;
  here.second_moment.diagonal().head<3>().array() +=
      coasted.position_sigma_m * coasted.position_sigma_m;
  here.second_moment.diagonal().tail<3>().array() +=
      coasted.rotation_sigma_rad * coasted.rotation_sigma_rad;
  result.uncertainty = here;
  front_end.certainty().count_stall(coasted.position_sigma_m);
  result.status = track::TrackingStatus::kWeak;
  result.reason =
      repeated_share > 0
          ? "most of the depth image repeats the last one: its transfer was incomplete"
          : "the depth image repeats the last one: the camera or its driver has stalled";
  ++tracked_frame_count;
  ++weak_frame_count;
  return coasted.seen_from_now;
}

// Tells the motion since the last tracked frame to those who need the camera's velocity.
void Reconstruction::step(double timestamp_s, const Rigid3& last_from_camera, bool is_corrected) {
  const bool is_known = lost_count == 0 && tracked_frame_count > 0;
  const std::optional<Rigid3> motion = is_known ? std::optional(last_from_camera) : std::nullopt;
  pace.step(timestamp_s, motion);
  shutter.step(timestamp_s, motion, is_corrected);
  if (watch) watch->step(timestamp_s, motion);
}

// Offers a frame that is not lost to the camera watch.
void Reconstruction::offer_to_watch(const frame::RgbdFrame& frame, MapEvent event) {
  if (event == MapEvent::kNewPart) watch->begin_component();
  if (!watch->wants(world_from_camera)) return;
  const std::optional<frame::RgbdFrame> rest = front_end.without_moving(frame);
  watch->view(rest ? *rest : frame, world_from_camera);
}

// Keeps the first frame of a camera with a rolling shutter out of the map: it could only be
// corrected with the camera's velocity, which the next frame tells. Else what it shows in wrong
// places would stay there.
void Reconstruction::wait_for_velocity(const frame::PreparedFrame& taken, FrameResult& result) {
  last_depth_digest = taken.content.depth_digest;
  front_end.learn_noise(taken);
  timed("preprocess", [&] { front_end.preprocess(taken.frame, result.frame_index); });
  timed("predict", [&] { front_end.keep(taken, layout()); });
  step(result.timestamp_s, Rigid3{}, false);
  result.status = track::TrackingStatus::kWeak;
  result.reason =
      "the map begins with the next frame, which tells how fast the camera moves: it has a rolling "
      "shutter";
  ++tracked_frame_count;
  ++weak_frame_count;
}

// Returns the frame corrected for a rolling shutter; nullopt if there is nothing to correct.
std::optional<RollingShutter::Corrected> Reconstruction::in_one_instant(
    const frame::PreparedFrame& taken, std::int64_t frame_index) {
  std::optional<RollingShutter::Corrected> corrected;
  if (!shutter.is_rolling() || tracked_frame_count == 0) return corrected;
  timed("retime", [&] {
    corrected =
        shutter.corrected(taken, front_end.corners.follow_points(
                                     taken.features, [](const Eigen::Vector2d&) { return false; }));
  });
  if (!corrected || front_end.frame_number > 0 || options.track.object) return corrected;
  timed("preprocess", [&] { front_end.preprocess(taken.frame, frame_index); });
  std::optional<Rigid3> last_from_camera;
  timed("track",
        [&] { last_from_camera = front_end.motion_since_kept(corrected->last_from_camera); });
  if (!last_from_camera) return corrected;
  std::optional<RollingShutter::Corrected> better =
      shutter.corrected_again(taken, *corrected, *last_from_camera);
  return better ? better : corrected;
}

// Returns the frame corrected by the motion that tracking has found; nullopt if that makes no
// difference. Not of an object, whose frames cannot be tracked twice.
std::optional<RollingShutter::Corrected> Reconstruction::corrected_by(
    const Motion& motion, const frame::PreparedFrame& taken,
    const std::optional<RollingShutter::Corrected>& before) {
  std::optional<RollingShutter::Corrected> better;
  if (!before || front_end.frame_number == 0 || options.track.object ||
      motion.judgement.status == track::TrackingStatus::kLost)
    return better;
  timed("retime", [&] {
    better = shutter.corrected_again(taken, *before, motion.odometry.reference_from_camera);
  });
  return better;
}

Motion Reconstruction::track(const frame::PreparedFrame& prepared, std::int64_t frame_index) {
  track::CornerVerdict seen;
  timed("preprocess", [&] {
    front_end.preprocess(prepared.frame, frame_index);
    front_end.commands.submit_and_wait_beside(
        [&] { seen = front_end.corners.follow_tracks(prepared.features); });
  });
  Motion motion;
  timed("track", [&] {
    motion = front_end.track(prepared, seen, world_from_camera, last_motion, lost_count);
  });
  return motion;
}

FrameResult Reconstruction::process(const frame::PreparedFrame& taken) {
  FrameResult result;
  result.frame_index = static_cast<std::int64_t>(poses.size());
  result.timestamp_s = taken.frame.timestamp_s;
  result.surfel_count = front_end.store.surfel_count();
  Rigid3 camera_from_frame;
  if (is_repeated(taken))
    camera_from_frame = coast(taken.repeated_share, result);
  else if (shutter.is_rolling() && poses.size() == 0)
    wait_for_velocity(taken, result);
  else
    track_and_fuse(taken, result);
  if (poses.size() > 0)
    pace.count_interval(result.timestamp_s - poses.anchored().back().timestamp_s,
                        poses.size() == 1);
  poses.add(result, reasons.number_of(result.reason), world_from_camera * camera_from_frame,
            layout());
  poses.describe_last(lost_count, result);
  gravity.add(taken.frame.acceleration_m_s2, poses.anchored().back());
  return result;
}

void Reconstruction::track_and_fuse(const frame::PreparedFrame& taken, FrameResult& result) {
  const auto start = std::chrono::steady_clock::now();
  const frame::FrameContent& content = taken.content;
  last_depth_digest = content.depth_digest;
  front_end.learn_noise(taken);
  std::optional<RollingShutter::Corrected> corrected = in_one_instant(taken, result.frame_index);
  const std::vector<Rigid3> poses_before = layout().world_from_submap;
  Motion motion = track(corrected ? corrected->frame : taken, result.frame_index);
  if (std::optional<RollingShutter::Corrected> better = corrected_by(motion, taken, corrected)) {
    corrected = std::move(better);
    motion = track(corrected->frame, result.frame_index);
  }
  const frame::PreparedFrame& prepared = corrected ? corrected->frame : taken;
  const frame::RgbdFrame& frame = prepared.frame;
  if (front_end.frame_number == 0 && corrected)
    motion.odometry.reference_from_camera = corrected->last_from_camera;
  track::SightGap gap{.unseen_s = unseen_s(result.timestamp_s)};
  if (mapping && lost_count == 0 && uncertainty.elsewhere_m == 0)
    known_keyframes = mapping->counts().keyframes;
  if (motion.judgement.status != track::TrackingStatus::kLost)
    world_from_camera = world_from_camera * motion.odometry.reference_from_camera;
  if (mapping && motion.judgement.status != track::TrackingStatus::kLost)
    timed("adjust", [&] { result.event = observe(frame, world_from_camera); });
  if (mapping && motion.judgement.status == track::TrackingStatus::kLost)
    timed("find", [&] { result.event = relocalise(prepared, gap, motion); });

  const bool lost = motion.judgement.status == track::TrackingStatus::kLost;
  if (lost != (lost_count > 0) && tracked_frame_count > 0 && result.event == MapEvent::kNone)
    result.event = lost ? MapEvent::kLost : MapEvent::kFoundAgain;
  result.correction_m = farthest_correction_m(poses_before, layout());
  if (lost || result.event != MapEvent::kNone || result.correction_m > kCorrectionThatMovesViews_m)
    front_end.forget_views();
  if (!lost) {
    const ColorUse color{fusion_of_colors(motion.judgement), motion.odometry.brightness};
    bool is_full = false;
    timed("fuse", [&] {
      is_full = !front_end.fuse(world_from_camera, layout(), color);
      front_end.commands.submit_and_wait_beside([&] {
        judge_uncertainty(frame, gap, motion, result);
        front_end.remember_view(world_from_camera, motion.odometry.reference_from_camera, prepared);
        step(result.timestamp_s, motion.odometry.reference_from_camera, corrected.has_value());
      });
    });
    last_motion = motion.odometry.reference_from_camera;
    if (is_full) motion.judgement = of_full_map(std::move(motion.judgement));
    timed("predict", [&] { front_end.clean_and_predict(color); });
    ++tracked_frame_count;
    weak_frame_count += motion.judgement.status == track::TrackingStatus::kWeak ? 1 : 0;
  }
  lost_count = lost ? lost_count + 1 : 0;
  if (!lost) unplaced_count = 0;

  describe_motion(motion, result);
  result.surfel_count = front_end.store.surfel_count();
  if (watch && !lost) offer_to_watch(frame, result.event);
  ++timed_frame_count;
  total_ms +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

template <class Bytes, class Saved>
void Reconstruction::fields(Bytes& bytes, Saved& saved) {
  rigid3_fields(bytes, saved.world_from_camera);
  rigid3_fields(bytes, saved.last_motion);
  CameraPace::fields(bytes, saved.pace);
  bytes.number(saved.lost_count);
  bytes.number(saved.unplaced_count);
  bytes.number(saved.known_keyframes);
  bytes.numbers(saved.uncertainty.second_moment.data(), 36);
  bytes.number(saved.uncertainty.way_m);
  bytes.number(saved.uncertainty.elsewhere_m);
  bytes.number(saved.last_depth_digest);
  FramePoses::fields(bytes, saved.poses);
  FeltGravity::fields(bytes, saved.gravity);
  bytes.number(saved.tracked_frame_count);
  bytes.number(saved.weak_frame_count);
}

void Reconstruction::save(ByteWriter& bytes) const {
  fields(bytes, *this);
  reasons.save(bytes);
  if (mapping) mapping->save(bytes);
  if (watch) watch->save(bytes);
  shutter.save(bytes);
  front_end.save(bytes);
}

void Reconstruction::restore(ByteReader& bytes) {
  fields(bytes, *this);
  reasons.restore(bytes);
  if (mapping) mapping->restore(bytes);
  if (watch) watch->restore(bytes);
  shutter.restore(bytes);
  front_end.restore(bytes);
  const auto frames = static_cast<std::int64_t>(poses.size());
  const std::size_t submaps = layout().world_from_submap.size();
  bytes.require(poses.size() == poses.trajectory().size() && tracked_frame_count >= 0 &&
                    tracked_frame_count <= frames && weak_frame_count >= 0 &&
                    weak_frame_count <= frames && lost_count >= 0 && lost_count <= frames &&
                    unplaced_count >= 0 && unplaced_count <= lost_count,
                "the number of frames is inconsistent");
  bytes.require(pace.is_valid(), "the camera's last velocity or its usual interval is no number");
  bytes.require(known_keyframes >= 0 && uncertainty.elsewhere_m >= 0,
                "the doubt about the camera's place");
  poses.require_valid(bytes, submaps, reasons.size());
  bytes.require(front_end.store.world_from_submap().size() <= submaps && gravity.is_valid(submaps),
                "the number of submaps is inconsistent");
}

void Reconstruction::finish() {
  if (!mapping) return;
  mapping->finish();
  front_end.store.set_submaps(layout().world_from_submap);
  poses.follow_corrections(layout());
}

}  // namespace hermite::pipeline
