#include "server/scan/scan_camera.h"

#include <fmt/core.h>

#include <utility>

namespace hermite::server {

std::uint64_t ScanCamera::attach(CameraLink link) {
  // The old link is detached before it is notified, so that its reactions have no effect here.
  const std::optional<CameraLink> superseded = std::exchange(link_, std::move(link));
  waiting_since_.reset();
  silent_since_.reset();
  ++link_count_;
  if (superseded) superseded->superseded();
  return link_count_;
}

bool ScanCamera::detach(std::uint64_t link) {
  if (link != link_count_ || !link_) return false;
  link_.reset();
  return true;
}

void ScanCamera::send(wire::ServerMessage message) {
  if (link_) link_->send(std::move(message));
}

void ScanCamera::say_ended() {
  if (link_) link_->ended();
}

void ScanCamera::say_go_away() {
  if (link_) link_->go_away();
}

void ScanCamera::wait(const Error& why, Clock::time_point now) {
  why_waiting_ = why;
  waiting_since_ = now;
}

void ScanCamera::frame_came() { silent_since_.reset(); }

bool ScanCamera::pause(bool paused) {
  if (paused_ == paused) return false;
  paused_ = paused;
  silent_since_.reset();
  return true;
}

Status ScanCamera::ask_to_pause(bool paused) {
  if (!link_) return Error{ErrorCode::kBusy, "the camera is not connected at the moment"};
  if (!link_->can_pause) return Error{ErrorCode::kBusy, "this camera cannot be asked to pause"};
  link_->send(wire::PauseRequest{paused});
  return Done{};
}

std::string ScanCamera::message() const {
  if (waiting_since_) return "waiting for the camera to come back: " + why_waiting_.message;
  return paused_ ? "paused by its camera" : "";
}

std::optional<Error> ScanCamera::given_up(bool may_send, Clock::time_point now) {
  if (waiting_since_) {
    if (now - *waiting_since_ < resume_window_) return std::nullopt;
    waiting_since_.reset();
    return why_waiting_;
  }
  // A camera without credit waits for the server.
  if (!link_ || !may_send) {
    silent_since_.reset();
    return std::nullopt;
  }
  if (!silent_since_) silent_since_ = now;
  const std::chrono::milliseconds patience = paused_ ? kMaxPause : frame_patience_;
  if (now - *silent_since_ < patience) return std::nullopt;
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(patience).count();
  return Error{ErrorCode::kBusy, fmt::format("the camera sent no frame for {} s{}", seconds,
                                             paused_ ? ", in which it was paused" : "")};
}

}  // namespace hermite::server
