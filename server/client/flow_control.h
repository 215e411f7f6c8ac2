// When a frame may leave: what the server granted, and what the clock of a live camera asks. Knows no socket and reads no clock:
// the time is an argument. Single-threaded values.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/base/result.h"
#include "server/client/frame_encoder.h"

namespace hermite {

using SteadyTime = std::chrono::steady_clock::time_point;

// Frames the server has room for. The grants are totals since the start, so a repeated or late one changes nothing.
class CreditWindow {
 public:
  // Over a new connection both counts may be lower than they were.
  explicit CreditWindow(std::uint64_t frames_granted = 0, std::uint64_t frames_sent = 0) : granted_(frames_granted), sent_(frames_sent) {}
  void grant_in_all(std::uint64_t frames_granted);
  bool available() const { return sent_ < granted_; }
  void take();  // CHECKs available()
  std::uint64_t sent() const { return sent_; }

 private:
  std::uint64_t granted_ = 0;
  std::uint64_t sent_ = 0;
};

struct Pacing {
  std::optional<double> rate_hz;  // none: as fast as the credit allows
  // Live: a frame that is still waiting when the next one is due is dropped, and counted. Without a rate the frames come from a camera,
  // which has a clock of its own: each is due when it is there.
  bool newest_wins = false;
};

// At most one frame waiting for its time and for credit. Frame k is due k / rate_hz after the first one was offered.
//
//   while (gate.wants(now) && (frame = next encoded frame)) gate.offer(std::move(*frame), now);
//   if (connection is free) if (auto frame = gate.take(now, credit.available())) send it
class FrameGate {
 public:
  explicit FrameGate(const Pacing& pacing);

  // Whether the next frame should be offered now. Batch: when none waits. Live: also when the next one is due, replacing the one that
  // waits.
  bool wants(SteadyTime now) const;
  void offer(EncodedFrame frame, SteadyTime now);  // CHECKs wants(now)

  // Live only (CHECK): from now on the first `kept` of every `of` frames offered wait to be sent, the others are left out, which is no
  // drop.
  void keep(int kept, int of);

  // The waiting frame when it is due and there is credit.
  std::optional<EncodedFrame> take(SteadyTime now, bool has_credit);

  bool empty() const { return !waiting_; }
  std::uint64_t dropped_count() const { return dropped_count_; }
  std::uint64_t left_out_count() const { return left_out_count_; }
  std::uint64_t due_count() const { return offered_count_ - left_out_count_; }

  // When the clock alone may change an answer above: the waiting frame becomes due, or (live) the next one does.
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
  std::uint64_t waiting_number_ = 0;  // of those offered
};

}  // namespace hermite
