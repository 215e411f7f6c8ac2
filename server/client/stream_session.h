// One scan that is streamed to a server, for stream_frames(): connects, greets the server, sends
// frames until it has the result, and gets a lost connection back. What is sent is in
// outgoing_frames.h, what the server says in server_answers.h.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "core/base/result.h"
#include "server/client/flow_control.h"
#include "server/client/frame_source.h"
#include "server/client/link.h"
#include "server/client/outgoing_frames.h"
#include "server/client/server_answers.h"
#include "server/client/stream.h"
#include "server/client/stream_report.h"

namespace hermite::client {

// The course of a scan while it is streamed, over one connection after another. Belongs to one
// thread.
class StreamSession {
 public:
  StreamSession(FrameSource& source, const StreamRequest& request, const StreamObserver& observer);
  Status run();  // as stream_frames()
  void close();
  StreamOutcome outcome() const;  // only after run() has succeeded

 private:
  Status begin();
  Status connect();
  Status greet();
  Status pump();
  Status finish();
  Status resume(const Error& lost);
  Status get_back(const Error& lost, const std::function<Status()>& ask);
  Status ask_to_resume();
  Status wait_before_connecting(std::chrono::milliseconds wait);
  Status step(std::optional<SteadyTime> next_event);
  void send_next_frame();
  bool server_has_work();
  int interrupts() const { return observer_.interrupt_count ? observer_.interrupt_count() : 0; }
  void tell_progress();
  void follow_pause(SteadyTime now);

  FrameSource& source_;
  const StreamRequest& request_;
  const StreamObserver& observer_;
  StreamReport report_;

  Link link_;
  OutgoingFrames frames_;  // after the link, which its encoder wakes
  ServerAnswers answers_;
  // No frames: somebody who watches has asked for it, or the camera is paused.
  bool paused_ = false;
  bool told_paused_ = false;  // what the server was told over this connection
  bool link_lost_ = false;    // the error of step() is then no reason to give up the scan
  SteadyTime quiet_since_;    // since then the server has had work and taken no bytes
};

}  // namespace hermite::client
