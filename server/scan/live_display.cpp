#include "server/scan/live_display.h"

#include <optional>
#include <utility>
#include <vector>

namespace hermite::server {

namespace {

constexpr const char* kNoSurface =
    "the map is too large for a surface that grows with it: its points are shown";

}  // namespace

LiveDisplay::LiveDisplay(const Scan& scan, Subscribers& subscribers)
    : scan_(scan), subscribers_(subscribers) {
  show_state_to_viewers();
}

wire::ScanState LiveDisplay::state(const std::string& message) const {
  const ScanCamera& camera = scan_.camera;
  const bool paused = !scan_.lifecycle.is_over() && (camera.is_paused() || camera.is_waited_for());
  const bool can_pause = scan_.lifecycle.takes_frames() && camera.can_pause();
  const FrameCounts& counts = scan_.frames.counts();
  return {scan_.lifecycle.phase(),
          message,
          counts.received,
          counts.processed,
          counts.dropped,
          keyframes_,
          loops_,
          paused,
          can_pause,
          up_};
}

std::string LiveDisplay::message() const {
  if (std::string of_camera = scan_.camera.message(); !of_camera.empty()) return of_camera;
  if (!worker_message_.empty()) return worker_message_;
  return warning_.empty() && mesh_ended_ ? kNoSurface : warning_;
}

void LiveDisplay::show_state() {
  const wire::ScanState now = state(message());
  subscribers_.show_state(now);
  scan_.camera.send(now);
}

void LiveDisplay::show_state_to_viewers() { subscribers_.show_state(state(message())); }

void LiveDisplay::warn(const std::string& message) {
  if (warning_ == message || scan_.lifecycle.is_over()) return;
  warning_ = message;
  show_state();
}

void LiveDisplay::worker_says(const std::string& message) {
  worker_message_ = message;
  show_state();
}

void LiveDisplay::restored(RestoredScan restored) {
  subscribers_.show_past(restored.past);
  if (restored.processed > 0) subscribers_.show_poses(std::move(restored.poses));
}

void LiveDisplay::frame_done(const FrameOutcome& outcome) {
  arrivals_.frame_done(outcome.result.sequence, outcome.arrived, Arrivals::Clock::now());
  if (outcome.poses) subscribers_.show_poses(*outcome.poses);
  if (outcome.past) subscribers_.show_other_past(*outcome.past);
  subscribers_.show_result(outcome.result);
}

void LiveDisplay::model_changed(ModelUpdate update) {
  keyframes_ = update.keyframes;
  loops_ = update.loops;
  up_ = update.up;
  gpu_memory_bytes_ = update.gpu_memory_bytes;
  if (!update.chunks.empty())
    arrivals_.points_encoded(update.encoding.start, Arrivals::Clock::now());
  const std::optional<std::vector<wire::PoseInSubmap>> past = std::move(update.past);
  subscribers_.show_model(std::move(update));
  if (past) subscribers_.show_other_past(*past);
  show_state();
}

void LiveDisplay::mesh_changed(MeshUpdate update) {
  if (update.ended) {
    mesh_ended_ = true;
    show_state();
  }
  if (!update.pieces.empty()) arrivals_.surface_made(update.delay);
  subscribers_.show_mesh(std::move(update));
}

wire::ScanState LiveDisplay::close(const std::string& message) {
  wire::ScanState last = state(message);
  subscribers_.show_state(last);
  subscribers_.close();
  return last;
}

}  // namespace hermite::server
