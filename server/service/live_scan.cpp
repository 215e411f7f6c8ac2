#include "server/service/live_scan.h"

#include <cmath>
#include <utility>

namespace hermite {

namespace {

Error broken_rule(const std::string& words) { return {ErrorCode::kInvalidArgument, words}; }

}  // namespace

LiveScan::LiveScan(ScanTerms terms, std::shared_ptr<Audience> audience, std::function<void(const ScanEnd&)> on_ended)
    : terms_(terms), audience_(std::move(audience)), on_ended_(std::move(on_ended)) {
  audience_->show_state(state(""));
}

void LiveScan::start(std::unique_ptr<ScanWorker> worker) { worker_ = std::move(worker); }

void LiveScan::send(wire::ServerMessage message) {
  if (camera_) camera_->send(std::move(message));
}

wire::ScanState LiveScan::state(const std::string& words) const {
  return {phase_, words, counts_.received, counts_.processed, counts_.dropped, keyframes_, loops_};
}

// Every frame that was taken care of, in whatever way, makes room for another one.
void LiveScan::grant() { send(wire::Credit{counts_.processed + counts_.dropped + terms_.credit_window}); }

void LiveScan::refuse(std::uint64_t sequence, const Error& error) {
  send(wire::ErrorMessage{name_of(error.code), error.message, true, sequence});
}

Status LiveScan::receive(wire::Frame frame) {
  if (over()) return Done{};  // it was under way when the scan ended
  if (finishing_) return broken_rule("frame " + std::to_string(frame.sequence) + " came after finish");
  if (frame.sequence != counts_.received)
    return broken_rule("frame.sequence is " + std::to_string(frame.sequence) + ", expected is " + std::to_string(counts_.received) +
                       ": frames are numbered 0, 1, 2, ... without gaps");
  const std::uint64_t granted = counts_.processed + counts_.dropped + terms_.credit_window;
  if (counts_.received >= granted)
    return broken_rule("frame " + std::to_string(frame.sequence) + " came without credit: granted are " + std::to_string(granted) +
                       " frames in all");
  if (counts_.received >= kMaxFramesPerScan)
    return Error{ErrorCode::kTooLarge, "a scan has at most " + std::to_string(kMaxFramesPerScan) + " frames"};
  ++counts_.received;

  const double time_s = frame.timestamp_s;
  const bool usable = std::isfinite(time_s) && std::abs(time_s) <= kMaxTimestamp_s;
  if (!usable || (last_timestamp_s_ && time_s <= *last_timestamp_s_)) {
    // Without a time of its own it can have no line in the trajectory.
    refuse(frame.sequence, broken_rule(!usable ? "frame.timestamp_s is not a finite number of at most 1e11 s"
                                               : "frame.timestamp_s is " + std::to_string(time_s) + ", not after " +
                                                     std::to_string(*last_timestamp_s_) + " of the frame before"));
    ++counts_.dropped;
    grant();
    return Done{};
  }
  last_timestamp_s_ = time_s;
  if (worker_->push(std::move(frame))) {
    ++counts_.dropped;
    grant();
  }
  return Done{};
}

void LiveScan::finish() {
  finishing_ = true;
  if (worker_) worker_->finish();
}

void LiveScan::camera_left(const Error& why) {
  camera_.reset();
  if (worker_ && !finishing_) worker_->interrupt(why, false);
}

void LiveScan::stop() {
  if (worker_) worker_->interrupt({ErrorCode::kBusy, "the server was stopped during the scan"}, true);
}

void LiveScan::frame_done(const FrameOutcome& outcome) {
  ++counts_.processed;
  if (outcome.bad_images) refuse(outcome.result.sequence, *outcome.bad_images);
  send(outcome.result);
  grant();
  if (outcome.poses) audience_->show_poses(*outcome.poses);
  audience_->show_result(outcome.result);
}

void LiveScan::model_changed(ModelUpdate update) {
  keyframes_ = update.keyframes;
  loops_ = update.loops;
  gpu_memory_bytes_ = update.gpu_memory_bytes;
  audience_->show_model(std::move(update));
  const wire::ScanState now = state("");
  audience_->show_state(now);
  send(now);
}

void LiveScan::ended(ScanEnd end) {
  worker_.reset();  // its thread is at its end: this was its last word
  phase_ = end.phase;
  on_ended_(end);
  const wire::ScanState last = state(end.words);
  audience_->show_state(last);
  audience_->close();
  if (phase_ != wire::ScanPhase::kFinished) send(wire::ErrorMessage{name_of(end.error.code), end.error.message, false, 0});
  send(last);
  if (phase_ == wire::ScanPhase::kFinished) send(std::move(end.results));
  if (camera_) camera_->ended();
}

}  // namespace hermite
