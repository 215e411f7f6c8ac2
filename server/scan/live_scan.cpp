#include "server/scan/live_scan.h"

#include <fmt/core.h>

#include <utility>

#include "core/run/results.h"

namespace hermite::server {

namespace {

wire::ErrorMessage refusal(std::uint64_t sequence, const Error& error) {
  return {name_of(error.code), error.message, true, sequence};
}

}  // namespace

LiveScan::LiveScan(ScanTerms terms, const ScanPast& past, std::shared_ptr<Subscribers> subscribers,
                   std::function<void(const ScanEnd&)> on_ended)
    : terms_(std::move(terms)),
      subscribers_(std::move(subscribers)),
      on_ended_(std::move(on_ended)),
      camera_(terms_.resume_window, terms_.frame_patience),
      frames_(terms_.credit_window, terms_.expected_frames, past),
      lifecycle_(past.finished),
      display_({frames_, lifecycle_, camera_}, *subscribers_) {}

LiveScan::~LiveScan() { subscribers_->tell_mesh_wanted(nullptr); }

void LiveScan::start(std::unique_ptr<ScanWorker> worker, std::unique_ptr<frame_log::FrameLog> log) {
  worker_ = std::move(worker);
  log_ = std::move(log);
  subscribers_->tell_mesh_wanted([this](bool wanted) { worker_->want_mesh(wanted); });
  if (lifecycle_.has_all_frames()) worker_->finish();
}

std::uint64_t LiveScan::attach_camera(CameraLink camera) {
  const std::uint64_t link = camera_.attach(std::move(camera));
  display_.show_state_to_viewers();
  return link;
}

Result<wire::Resumed> LiveScan::resume(std::uint64_t next_sequence) {
  if (lifecycle_.is_ending())
    return Error{ErrorCode::kNotFound,
                 "the scan is being ended: " + lifecycle_.why_ending().message};
  const std::uint64_t received = frames_.counts().received;
  if (next_sequence > received) {
    const Error lost{
        ErrorCode::kIo,
        fmt::format("the server has frames 0 to {} (exclusive) of the scan and the camera only "
                    "those from {} on: the disk has lost what lies between",
                    received, next_sequence)};
    end_early(lost);
    return lost;
  }
  return wire::Resumed{received, frames_.granted(), frames_.durable_count()};
}

// A disk error ends the scan, but is not a protocol violation of the camera.
Status LiveScan::log_record(frame_log::RecordType type, std::string_view message) {
  const Status logged = log_->append(type, std::string(message));
  if (!logged.ok()) log_failed(logged.error());
  return logged;
}

Status LiveScan::receive(wire::Frame frame, std::string_view message) {
  if (lifecycle_.is_ending()) return Done{};  // the frame was in transit when the scan ended
  if (lifecycle_.has_all_frames())
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("frame {} came after finish", frame.sequence)};
  if (Status received = frames_.receive(frame.sequence); !received.ok()) return received;
  camera_.frame_came();
  pause(false);

  if (const Status usable = frames_.take_timestamp(frame.timestamp_s); !usable.ok()) {
    // A frame without a unique timestamp cannot be in the trajectory.
    camera_.send(refusal(frame.sequence, usable.error()));
    if (log_record(frame_log::RecordType::kRefusedFrame, {}).ok()) camera_.send(frames_.credit());
    return Done{};
  }
  if (!log_record(frame_log::RecordType::kFrame, message).ok()) return Done{};
  if (worker_->push(std::move(frame))) {
    frames_.dropped();
    camera_.send(frames_.credit());
  }
  return Done{};
}

void LiveScan::finish() {
  if (!lifecycle_.takes_frames()) return;
  if (!log_record(frame_log::RecordType::kFinish, {}).ok()) return;
  lifecycle_.all_frames_came();
  worker_->finish();
}

void LiveScan::pause(bool paused) {
  if (!lifecycle_.is_ending() && camera_.pause(paused)) display_.show_state();
}

Status LiveScan::ask_to_pause(bool paused) {
  if (!lifecycle_.takes_frames())
    return Error{ErrorCode::kBusy, "the scan takes no frames any more"};
  return camera_.ask_to_pause(paused);
}

void LiveScan::discard() {
  if (lifecycle_.discard() && worker_) worker_->abandon(Abandon::kForGood);
}

void LiveScan::end_early(const Error& why, EndCause cause) {
  if (lifecycle_.end_early(why, cause) && worker_) worker_->interrupt(why, false);
}

void LiveScan::camera_left(std::uint64_t link, const Error& why, bool broke_rule) {
  if (!camera_.detach(link)) return;
  if (!lifecycle_.takes_frames()) return;
  if (broke_rule || !terms_.resumable()) return end_early(why);
  wait_for_camera(why);
}

void LiveScan::wait_for_camera(const Error& why) {
  camera_.wait(why, Clock::now());
  display_.show_state();
}

void LiveScan::tick(Clock::time_point now) {
  const bool may_send = lifecycle_.takes_frames() && frames_.camera_may_send();
  if (const std::optional<Error> why = camera_.given_up(may_send, now)) end_early(*why);
}

void LiveScan::stop() {
  const Error why{ErrorCode::kBusy, "the server was stopped during the scan"};
  if (!worker_ || lifecycle_.is_discarded()) return;
  if (!terms_.resumable()) return worker_->interrupt(why, true);
  // The frames are on disk and the camera can reconnect: the scan need not end.
  lifecycle_.leave(why);
  worker_->abandon(Abandon::kToGoOn);
}

std::uint64_t LiveScan::results_bytes() const {
  return run::room_for_results(surfel_count_, frames_.counts().received);
}

void LiveScan::frames_durable(std::uint64_t count) {
  frames_.durable(count);
  if (worker_) worker_->frames_durable(count);
  if (!lifecycle_.is_ending()) camera_.send(frames_.credit());
}

void LiveScan::log_failed(const Error& error) {
  end_early(in_context("the scan's frames cannot be stored", error));
}

void LiveScan::restored(RestoredScan restored) {
  frames_.restored(restored.processed, restored.dropped);
  display_.restored(std::move(restored));
  camera_.send(frames_.credit());
  display_.show_state();
}

void LiveScan::frame_done(const FrameOutcome& outcome) {
  frames_.processed();
  surfel_count_ = outcome.result.surfel_count;
  if (outcome.bad_images) camera_.send(refusal(outcome.result.sequence, *outcome.bad_images));
  camera_.send(outcome.result);
  camera_.send(frames_.credit());
  display_.frame_done(outcome);
}

void LiveScan::ended(ScanEnd end) {
  subscribers_->tell_mesh_wanted(nullptr);
  worker_.reset();                    // its thread has ended: this was its last event
  const Status kept = log_->close();  // from here on everything is on disk, or never will be
  log_.reset();
  // Its results are complete. The camera has been told of fewer durable frames, but is about to
  // forget them all.
  if (!kept.ok() && end.phase == wire::ScanPhase::kFinished)
    end.message += (end.message.empty() ? "" : "; ") +
                   in_context("its last frames are not kept", kept.error()).message;
  end = lifecycle_.ended(std::move(end));
  camera_.stop_waiting();
  on_ended_(end);
  if (!lifecycle_.is_over()) {
    // Viewers are not notified either: to them the scan is still running.
    camera_.say_go_away();
    return;
  }
  const wire::ScanState last = display_.close(end.message);
  if (end.phase != wire::ScanPhase::kFinished && !end.discarded)
    camera_.send(wire::ErrorMessage{name_of(end.error.code), end.error.message, false, 0});
  camera_.send(last);
  if (end.phase == wire::ScanPhase::kFinished) camera_.send(std::move(end.results));
  camera_.say_ended();
}

}  // namespace hermite::server
