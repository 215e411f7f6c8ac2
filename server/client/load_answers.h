// How long the frames of a stream wait for their results, as its progress shows it. Reads no clock.
// Single-threaded values.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "server/client/flow_control.h"
#include "server/client/stream.h"

namespace hermite::client {

// Times from the beginning of sending a frame to the arrival of its result.
//
// A stream reports its progress after every event, before it sends another frame: a frame that is
// new in a report was sent right after the report before it. What is measured is therefore too long
// by the time for putting one message together (well below a millisecond), and never too short.
class AnswerTimes {
 public:
  void see(const StreamProgress& progress, SteadyTime now);  // with every progress, in order

  // Results that cannot be timed are missing: those that a server does not repeat after a lost
  // connection.
  const std::vector<float>& times_ms() const { return times_ms_; }

 private:
  struct Sent {
    std::uint64_t sequence = 0;
    SteadyTime at;
  };
  std::deque<Sent> waiting_;
  std::uint64_t sent_count_ = 0;
  std::uint64_t next_result_ = 0;
  std::optional<SteadyTime> last_seen_;
  std::vector<float> times_ms_;
};

// How many frames of a live stream should have been there by its clock, and how many were. A tool
// that cannot make them in time offers less than it was asked for.
class OfferedFrames {
 public:
  explicit OfferedFrames(double rate_hz) : rate_hz_(rate_hz) {}
  void see(const StreamProgress& progress, SteadyTime now);  // with every progress, in order

  std::uint64_t offered() const { return offered_; }  // sent, dropped or left out by the client
  std::uint64_t due() const { return due_; }          // at least offered()

 private:
  double rate_hz_;
  std::optional<SteadyTime> first_at_;
  std::uint64_t offered_ = 0, due_ = 0;
};

}  // namespace hermite::client
