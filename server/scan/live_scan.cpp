#include "server/scan/live_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/run/results.h"

namespace hermite {

namespace {

Error broken_rule(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

constexpr const char* kNoSurface = "the map is too large for a surface that grows with it: its points are shown";
constexpr const char* kDiscarded = "discarded by its camera";

}  // namespace

LiveScan::LiveScan(ScanTerms terms, const ScanPast& past, std::shared_ptr<Subscribers> subscribers,
                   std::function<void(const ScanEnd&)> on_ended)
    : terms_(std::move(terms)),
      subscribers_(std::move(subscribers)),
      on_ended_(std::move(on_ended)),
      camera_(terms_.resume_window, terms_.frame_patience) {
  counts_.received = past.received;
  counts_.dropped = past.refused;
  durable_ = past.received;
  last_timestamp_s_ = past.last_timestamp_s;
  finishing_ = past.finished;
  subscribers_->show_state(state(""));
}

void LiveScan::start(std::unique_ptr<ScanWorker> worker, std::unique_ptr<FrameLog> log) {
  worker_ = std::move(worker);
  log_ = std::move(log);
  subscribers_->tell_mesh_wanted([this](bool wanted) { worker_->want_mesh(wanted); });
  if (finishing_) worker_->finish();
}

std::uint64_t LiveScan::attach_camera(CameraLink camera) {
  const std::uint64_t link = camera_.attach(std::move(camera));
  subscribers_->show_state(state(message()));
  return link;
}

Result<wire::Resumed> LiveScan::resume(std::uint64_t next_sequence) {
  if (no_more_frames()) return Error{ErrorCode::kNotFound, "the scan is being ended: " + why_ending_.message};
  if (next_sequence > counts_.received) {
    const Error lost{ErrorCode::kIo, "the server has frames 0 to " + std::to_string(counts_.received) +
                                         " (exclusive) of the scan and the camera " + "only those from " + std::to_string(next_sequence) +
                                         " on: the disk has lost what lies between"};
    end_early(lost);
    return lost;
  }
  return wire::Resumed{counts_.received, granted(), durable_};
}

wire::ScanState LiveScan::state(const std::string& message) const {
  const bool paused = !over() && (camera_.is_paused() || camera_.is_waited_for());
  const bool can_pause = takes_frames() && camera_.can_pause();
  return {phase_, message, counts_.received, counts_.processed, counts_.dropped, keyframes_, loops_, paused, can_pause};
}

std::string LiveScan::message() const {
  if (std::string of_camera = camera_.message(); !of_camera.empty()) return of_camera;
  if (!worker_message_.empty()) return worker_message_;
  return warning_.empty() && mesh_ended_ ? kNoSurface : warning_;
}

void LiveScan::show_state() {
  const wire::ScanState now = state(message());
  subscribers_->show_state(now);
  camera_.send(now);
}

// Every frame that was handled in any way and is on disk returns one credit. So the camera, which keeps frames until they are durable,
// never keeps more than its window.
std::uint64_t LiveScan::granted() const { return std::min(counts_.processed + counts_.dropped, durable_) + terms_.credit_window; }

void LiveScan::grant() { camera_.send(wire::Credit{granted(), durable_}); }

void LiveScan::refuse(std::uint64_t sequence, const Error& error) {
  camera_.send(wire::ErrorMessage{name_of(error.code), error.message, true, sequence});
}

// A disk error ends the scan, but is not a protocol violation of the camera.
Status LiveScan::log_record(RecordType type, std::string_view message) {
  const Status logged = log_->append(type, std::string(message));
  if (!logged.ok()) log_failed(logged.error());
  return logged;
}

Status LiveScan::receive(wire::Frame frame, std::string_view message) {
  if (no_more_frames()) return Done{};  // the frame was in transit when the scan ended
  if (finishing_) return broken_rule("frame " + std::to_string(frame.sequence) + " came after finish");
  if (frame.sequence != counts_.received)
    return broken_rule("frame.sequence is " + std::to_string(frame.sequence) + ", expected is " + std::to_string(counts_.received) +
                       ": frames are numbered 0, 1, 2, ... without gaps");
  if (counts_.received >= granted())
    return broken_rule("frame " + std::to_string(frame.sequence) + " came without credit: granted are " + std::to_string(granted()) +
                       " frames in all");
  if (counts_.received >= kMaxFramesPerScan)
    return Error{ErrorCode::kTooLarge, "a scan has at most " + std::to_string(kMaxFramesPerScan) + " frames"};
  ++counts_.received;
  camera_.frame_came();
  pause(false);

  const double time_s = frame.timestamp_s;
  const bool usable = std::isfinite(time_s) && std::abs(time_s) <= kMaxTimestamp_s;
  if (!usable || (last_timestamp_s_ && time_s <= *last_timestamp_s_)) {
    // A frame without a unique timestamp cannot be in the trajectory.
    refuse(frame.sequence, broken_rule(!usable ? "frame.timestamp_s is not a finite number of at most 1e11 s"
                                               : "frame.timestamp_s is " + std::to_string(time_s) + ", not after " +
                                                     std::to_string(*last_timestamp_s_) + " of the frame before"));
    ++counts_.dropped;
    if (log_record(RecordType::kRefusedFrame, {}).ok()) grant();
    return Done{};
  }
  last_timestamp_s_ = time_s;
  if (!log_record(RecordType::kFrame, message).ok()) return Done{};
  if (worker_->push(std::move(frame))) {
    ++counts_.dropped;
    grant();
  }
  return Done{};
}

void LiveScan::finish() {
  if (finishing_ || no_more_frames()) return;
  if (!log_record(RecordType::kFinish, {}).ok()) return;
  finishing_ = true;
  worker_->finish();
}

void LiveScan::pause(bool paused) {
  if (!no_more_frames() && camera_.pause(paused)) show_state();
}

Status LiveScan::ask_to_pause(bool paused) {
  if (!takes_frames()) return Error{ErrorCode::kBusy, "the scan takes no frames any more"};
  return camera_.ask_to_pause(paused);
}

void LiveScan::discard() {
  if (no_more_frames()) return;
  why_ending_ = {ErrorCode::kNotFound, kDiscarded};
  ending_ = discarded_ = true;
  if (worker_) worker_->abandon(Abandon::kForGood);
}

void LiveScan::end_early(const Error& why) {
  if (no_more_frames() || finishing_) return;
  ending_ = true;
  why_ending_ = why;
  if (worker_) worker_->interrupt(why, false);
}

void LiveScan::camera_left(std::uint64_t link, const Error& why, bool broke_rule) {
  if (!camera_.detach(link)) return;
  if (no_more_frames() || finishing_) return;
  if (broke_rule || !resumable()) return end_early(why);
  wait_for_camera(why);
}

void LiveScan::wait_for_camera(const Error& why) {
  camera_.wait(why, Clock::now());
  show_state();
}

void LiveScan::tick(Clock::time_point now) {
  const bool may_send = !finishing_ && !no_more_frames() && counts_.received < granted();
  if (const std::optional<Error> why = camera_.given_up(may_send, now)) end_early(*why);
}

void LiveScan::stop() {
  const Error why{ErrorCode::kBusy, "the server was stopped during the scan"};
  if (!worker_ || discarded_) return;
  if (!resumable()) return worker_->interrupt(why, true);
  // The frames are on disk and the camera can reconnect: the scan need not end.
  ending_ = true;
  why_ending_ = why;
  worker_->abandon(Abandon::kToGoOn);
}

void LiveScan::frames_durable(std::uint64_t count) {
  durable_ = count;
  if (worker_) worker_->frames_durable(count);
  if (!no_more_frames()) grant();
}

void LiveScan::no_more_room(const Error& why) {
  if (no_more_frames() || finishing_) return;
  lacked_room_ = true;
  end_early(why);
}

void LiveScan::warn(const std::string& message) {
  if (warning_ == message || over()) return;
  warning_ = message;
  show_state();
}

std::uint64_t LiveScan::results_bytes() const { return room_for_results(surfel_count_, counts_.received); }

void LiveScan::log_failed(const Error& error) { end_early(in_context("the scan's frames cannot be stored", error)); }

void LiveScan::restored(RestoredScan restored) {
  counts_.processed += restored.processed;
  counts_.dropped += restored.dropped;
  subscribers_->show_past(restored.past);
  if (restored.processed > 0) subscribers_->show_poses(std::move(restored.poses));
  grant();
  show_state();
}

void LiveScan::frame_done(const FrameOutcome& outcome) {
  ++counts_.processed;
  surfel_count_ = outcome.result.surfel_count;
  arrivals_.frame_done(outcome.result.sequence, outcome.arrived, Clock::now());
  if (outcome.bad_images) refuse(outcome.result.sequence, *outcome.bad_images);
  camera_.send(outcome.result);
  grant();
  if (outcome.poses) subscribers_->show_poses(*outcome.poses);
  if (outcome.past) subscribers_->show_other_past(*outcome.past);
  subscribers_->show_result(outcome.result);
}

void LiveScan::model_changed(ModelUpdate update) {
  keyframes_ = update.keyframes;
  loops_ = update.loops;
  gpu_memory_bytes_ = update.gpu_memory_bytes;
  if (!update.chunks.empty()) arrivals_.points_encoded(update.encoding.start, Clock::now());
  const std::optional<std::vector<wire::PoseInSubmap>> past = std::move(update.past);
  subscribers_->show_model(std::move(update));
  if (past) subscribers_->show_other_past(*past);
  show_state();
}

void LiveScan::mesh_changed(MeshUpdate update) {
  if (update.ended) {
    mesh_ended_ = true;
    show_state();
  }
  if (!update.pieces.empty()) arrivals_.surface_made(update.delay);
  subscribers_->show_mesh(std::move(update));
}

void LiveScan::worker_says(const std::string& message) {
  worker_message_ = message;
  show_state();
}

void LiveScan::ended(ScanEnd end) {
  subscribers_->tell_mesh_wanted(nullptr);
  worker_.reset();                    // its thread has ended: this was its last event
  const Status kept = log_->close();  // from here on everything is on disk, or never will be
  log_.reset();
  // Its results are complete. The camera has been told of fewer durable frames, but is about to forget them all.
  if (!kept.ok() && end.phase == wire::ScanPhase::kFinished)
    end.message += (end.message.empty() ? "" : "; ") + in_context("its last frames are not kept", kept.error()).message;
  if (discarded_) end = {wire::ScanPhase::kInterrupted, {ErrorCode::kNotFound, kDiscarded}, {}, kDiscarded, true};
  ending_ = true;
  camera_.stop_waiting();
  phase_ = end.phase;
  lacked_room_ = lacked_room_ || end.results_missing;
  on_ended_(end);
  if (phase_ == wire::ScanPhase::kRunning) {
    // Viewers are not notified either: to them the scan is still running.
    camera_.say_go_away();
    return;
  }
  const wire::ScanState last = state(end.message);
  subscribers_->show_state(last);
  subscribers_->close();
  if (phase_ != wire::ScanPhase::kFinished && !discarded_)
    camera_.send(wire::ErrorMessage{name_of(end.error.code), end.error.message, false, 0});
  camera_.send(last);
  if (phase_ == wire::ScanPhase::kFinished) camera_.send(std::move(end.results));
  camera_.say_ended();
}

}  // namespace hermite
