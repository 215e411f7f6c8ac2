// The frames of a source on their way to the server: encoded on a thread of their own, sent at
// their time and as far as the server's credit reaches, fewer or smaller over a slow link, and kept
// until the server has them on disk. Uses no socket and reads no clock. Belongs to one thread.
//
//   frames.offer(now, held);
//   if (connection is free && frames.has_credit()) {
//     frames.number_next(now);
//     if (frames.next()) { send it; frames.sent(); }
//   }
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/client/flow_control.h"
#include "server/client/frame_encoder.h"
#include "server/client/frame_source.h"
#include "server/client/link_adaption.h"
#include "server/client/sent_frames.h"
#include "server/client/stream_report.h"

namespace hermite::client {

// A server grants no more than its window (at most 256 frames) beyond the durable frames; one that
// grants more must not exhaust the memory.
inline constexpr std::size_t kMaxKeptFrames = 256;

class OutgoingFrames {
 public:
  // Source and report outlive this. The report gets the counts of frames.
  OutgoingFrames(FrameSource& source, const Pacing& pacing, StreamReport& report);

  // Starts encoding, as the server has agreed to take the frames. `on_ready` as for FrameEncoder;
  // it is not called after the end of this.
  void start(const wire::Welcome& welcome, std::function<void()> on_ready);

  // Takes encoded frames from the source: to be called regularly, also without a connection, since
  // a live camera does not wait. While `held`, the source waits. Does nothing before start().
  void offer(SteadyTime now, bool held);
  // To be called after a pause, in which no frames were offered.
  void go_on(SteadyTime now) { gate_.go_on(now); }
  // Whether the source has no more frames and none waits. To be called after start().
  bool exhausted() const { return encoder_->exhausted() && gate_.empty(); }
  // Whether a frame waits for its time or for credit.
  bool has_waiting() const { return !gate_.empty(); }
  // When the passing of time alone may next let a frame out.
  std::optional<SteadyTime> next_event(SteadyTime now) const { return gate_.next_event(now); }

  // Gives the waiting frame its number, if it is due and next() is not set, so that next() is this
  // frame. kTooLarge: it is longer than the server accepts.
  Status number_next(SteadyTime now);

  // The message of the next frame to send; nullptr: none is numbered. Valid until the next call.
  const std::string* next() const { return sent_.next(); }
  void sent();  // CHECKs next() and has_credit()
  bool has_credit() const { return credit_.available(); }
  void granted(const wire::Credit& credit);

  // Over a new connection the server continues where it is. kIo, with a message: it lacks frames
  // that are not kept any more.
  Status resume(const wire::Resumed& resumed);

  // The frames before it are on the server's disk.
  std::uint64_t first_kept() const { return sent_.first_kept(); }
  // Number of sent frames, without those that are to be sent again.
  std::uint64_t sent_count() const { return sent_.sent_count(); }

 private:
  void adapt_to_link(SteadyTime now);

  FrameSource& source_;
  StreamReport& report_;
  const bool is_live_;
  FrameGate gate_;
  SentFrames sent_;
  CreditWindow credit_;
  std::uint64_t max_message_bytes_ = 0;
  bool is_resumable_ = false;
  LinkState link_state_;
  LinkCounts counted_;        // counts when the link was last judged
  SteadyTime judge_link_at_;  // live only
  std::optional<FrameEncoder> encoder_;
};

}  // namespace hermite::client
