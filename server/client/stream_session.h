// One scan that is streamed to a server, for stream_frames(): the messages sent and received, over one connection after
// another.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/client/flow_control.h"
#include "server/client/frame_encoder.h"
#include "server/client/frame_source.h"
#include "server/client/link.h"
#include "server/client/link_adaption.h"
#include "server/client/sent_frames.h"
#include "server/client/stream.h"

namespace hermite {

template <class Message>
concept MessageForViewers = std::is_same_v<Message, wire::Chunk> || std::is_same_v<Message, wire::MeshChunk> ||
    std::is_same_v<Message, wire::SnapshotEnd> || std::is_same_v<Message, wire::TrajectoryPart>;

// The state of a scan while it is streamed, over one connection after another. Belongs to one thread.
class StreamSession {
 public:
  StreamSession(FrameSource& source, const StreamRequest& request, const StreamObserver& observer)
      : source_(source), request_(request), observer_(observer), link_(request.server, request.ca), gate_(request.pacing) {
    progress_.frame_count = static_cast<std::int64_t>(source.expected_frames());
  }
  Status run();  // as stream_frames()
  void close();
  StreamOutcome outcome() const {  // only after run() has succeeded
    return {finished_->report_json, finished_->trajectory_tum, progress_};
  }

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
  Status check_welcome() const;
  Status number(EncodedFrame encoded);
  void offer_frames(SteadyTime now);
  void adapt_to_link(SteadyTime now);
  void send_next_frame();
  bool resumable() const { return welcome_ && !welcome_->resume_token.empty(); }
  bool server_has_work();
  int interrupts() const { return observer_.interrupt_count ? observer_.interrupt_count() : 0; }
  void tell_problem(const std::string& message);
  void tell_link(const std::string& message);
  void tell_progress();
  void follow_pause(SteadyTime now);

  // In stream_heard.cpp.
  Status handle(const std::string& bytes);
  // One overload per message type of the protocol.
  void receive(const wire::Welcome& welcome);
  void receive(const wire::FrameResult& result);
  void receive(const wire::Credit& credit);
  void receive(const wire::ScanState& state);
  void receive(const wire::Finished& finished) { finished_ = finished; }
  void receive(const wire::ErrorMessage& error);
  void receive(const wire::Pong& pong) { link_.answered(pong); }
  void receive(const wire::Resumed& resumed) { resumed_ = resumed; }
  void receive(const wire::NotResumed& refused);
  void receive(const wire::GoAway& away);
  void receive(const wire::Waiting& waiting);
  void receive(const wire::PauseRequest& request);
  void receive(const wire::SubmapPoses&) {}
  void receive(const wire::Unknown&) { ++progress_.unknown_messages; }
  // A camera ignores them.
  template <MessageForViewers Message>
  void receive(const Message&) {
    ++progress_.unknown_messages;
  }

  FrameSource& source_;
  const StreamRequest& request_;
  const StreamObserver& observer_;

  Link link_;
  bool held_ = false;                     // frames of the source wait, since somebody who watches has asked for it
  bool paused_ = false;                   // held, or the camera is paused
  bool told_paused_ = false;              // what the server was told over this connection
  bool link_lost_ = false;                // the error of step() is then no reason to give up the scan
  std::optional<wire::Waiting> waiting_;  // waits for admission by the server
  SteadyTime hello_deadline_;
  std::optional<std::chrono::milliseconds> stay_away_;  // the server has said that it stops, and for how long to stay away

  StreamProgress progress_;
  CreditWindow credit_;
  FrameGate gate_;
  SentFrames frames_;
  std::uint64_t next_result_ = 0;  // earlier results were received; a rebuilt scan sends them again
  LinkState link_state_;
  LinkCounts counted_;        // counts when the link was last judged
  SteadyTime judge_link_at_;  // live only
  SteadyTime welcomed_at_;
  SteadyTime last_news_ = std::chrono::steady_clock::now();
  std::optional<wire::Welcome> welcome_;
  std::optional<wire::Resumed> resumed_;
  std::optional<wire::Finished> finished_;
  std::optional<Error> failure_;         // the server ended the scan
  std::optional<FrameEncoder> encoder_;  // last member: destroyed before the link that it wakes
};

}  // namespace hermite
