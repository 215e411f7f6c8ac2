// The camera of a running scan: whether one is attached, and how long the scan waits for it or for
// its next frame.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "proto/wire/messages.h"

namespace hermite::server {

// A coffee break. A camera that pauses for longer would keep others from scanning.
inline constexpr std::chrono::minutes kMaxPause(30);

// The connection to a camera.
struct CameraLink {
  std::function<void(wire::ServerMessage)> send;
  std::function<void()> ended;       // the scan has ended and everything was sent
  std::function<void()> superseded;  // another connection has taken the scan over
  std::function<void()> go_away;     // the server stops; the next server continues the scan
  bool can_pause = false;            // it follows a wire::PauseRequest
};

// Belongs to the network thread.
class ScanCamera {
 public:
  using Clock = std::chrono::steady_clock;

  // How long the scan waits for a lost camera, and how long a camera with credit may send nothing.
  ScanCamera(std::chrono::milliseconds resume_window, std::chrono::milliseconds frame_patience)
      : resume_window_(resume_window), frame_patience_(frame_patience) {}

  // Attaches a camera; a previous one is told that it is superseded. The returned number identifies
  // the link in detach().
  std::uint64_t attach(CameraLink link);
  // Returns false if another camera, or none, is attached.
  bool detach(std::uint64_t link);

  void send(wire::ServerMessage message);
  void say_ended();
  void say_go_away();

  // The scan waits for a camera to come back; `why` says what became of the last one.
  void wait(const Error& why, Clock::time_point now);
  void stop_waiting() { waiting_since_.reset(); }

  void frame_came();
  // Returns whether that is a change.
  bool pause(bool paused);
  // Asks the camera to pause or to go on. kBusy: none is connected, or this one cannot be asked.
  Status ask_to_pause(bool paused);

  bool is_paused() const { return paused_; }
  bool is_waited_for() const { return waiting_since_.has_value(); }
  bool can_pause() const { return link_ && link_->can_pause; }
  std::string message() const;  // for those who watch; empty: the camera sends frames

  // Returns why the scan gives its camera up: it did not come back in time or, although `may_send`,
  // has sent no frame for too long. Called periodically.
  std::optional<Error> given_up(bool may_send, Clock::time_point now);

 private:
  const std::chrono::milliseconds resume_window_, frame_patience_;
  std::optional<CameraLink> link_;
  std::uint64_t link_count_ = 0;
  bool paused_ = false;
  std::optional<Clock::time_point> waiting_since_;
  std::optional<Clock::time_point> silent_since_;
  Error why_waiting_;
};

}  // namespace hermite::server
