// Decides when a frame may be sent: by the credit that the server has granted, and by the clock of
// a live camera. Uses no socket and reads no clock: the time is an argument. Single-threaded
// values.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/base/result.h"
#include "server/client/frame_encoder.h"

namespace hermite::client {

using SteadyTime = std::chrono::steady_clock::time_point;

// Frames that the server has room for. Grants are totals since the start, so a repeated or late one
// changes nothing.
class CreditWindow {
 public:
  // For a new connection, both counts may be lower than before.
  explicit CreditWindow(std::uint64_t frames_granted = 0, std::uint64_t frames_sent = 0)
      : granted_(frames_granted), sent_(frames_sent) {}
  void grant_in_all(std::uint64_t frames_granted);
  bool available() const { return sent_ < granted_; }
  void take();  // CHECKs available()
  std::uint64_t sent() const { return sent_; }

 private:
  std::uint64_t granted_ = 0;
  std::uint64_t sent_ = 0;
};

struct Pacing {
  std::optional<double> rate_hz;  // std::nullopt: as fast as the credit allows
  // Live: a frame that still waits when the next one is due is dropped and counted. Without a rate,
  // the frames come from a camera, whose own clock determines when each is due: when it is
  // available.
  bool newest_wins = false;
};

// Holds at most one frame that waits for its time and for credit. Frame k is due k / rate_hz after
// the first one was offered.
//
//   while (gate.wants(now) && (frame = next encoded frame)) gate.offer(std::move(*frame), now);
//   if (connection is free) if (auto frame = gate.take(now, credit.available())) send it
class FrameGate {
 public:
  explicit FrameGate(const Pacing& pacing);

  // Returns whether the next frame should be offered now. Batch: if none waits. Live: also when the
  // next one is due, which replaces the waiting one.
  bool wants(SteadyTime now) const;
  void offer(EncodedFrame frame, SteadyTime now);  // CHECKs wants(now)

  // Live only (CHECK): from now on only the first `kept` of every `of` frames offered are sent. The
  // others are left out, which does not count as a drop.
  void keep(int kept, int of);

  // After a pause, in which no frames were offered: the next one is due now.
  void go_on(SteadyTime now);

  // Returns the waiting frame if it is due and there is credit.
  std::optional<EncodedFrame> take(SteadyTime now, bool has_credit);

  bool empty() const { return !waiting_; }
  std::uint64_t dropped_count() const { return dropped_count_; }
  std::uint64_t left_out_count() const { return left_out_count_; }
  std::uint64_t due_count() const { return offered_count_ - left_out_count_; }

  // Returns when the passing of time alone may next change an answer above: when the waiting frame
  // becomes due or, live, the next one does.
  std::optional<SteadyTime> next_event(SteadyTime now) const;

 private:
  SteadyTime due(std::uint64_t frame_number) const;

  Pacing pacing_;
  SteadyTime start_;
  std::uint64_t offered_count_ = 0;
  std::uint64_t dropped_count_ = 0;
  std::uint64_t left_out_count_ = 0;
  std::uint64_t kept_ = 1, of_ = 1;
  std::optional<EncodedFrame> waiting_;
  std::uint64_t waiting_number_ = 0;  // its number among those offered
};

}  // namespace hermite::client
