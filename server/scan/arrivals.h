// When the newest frames of a running scan came, so that its viewers can be told how far they are
// behind. All durations are between two readings of the clock of this machine: clocks of cameras
// and browsers have no part in them. Belongs to one thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace hermite::server {

class Arrivals {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMostFrames = 256;  // that are remembered

  // A frame that came at `arrived` has its result. Frames are told in order.
  void frame_done(std::uint64_t sequence, Clock::time_point arrived, Clock::time_point now);

  // Points were encoded, beginning at `began`: they show all frames that were done by then.
  void points_encoded(Clock::time_point began, Clock::time_point now);
  void surface_made(Clock::duration delay) { surface_delay_ = delay; }

  // When that frame came; std::nullopt if it is not one of the newest.
  std::optional<Clock::time_point> of(std::uint64_t sequence) const;

  // Time from the arrival of the oldest frame that the newest points show, and those before do not,
  // until they were ready to be sent.
  std::optional<Clock::duration> points_delay() const { return points_delay_; }
  // The same of the newest piece of the surface.
  std::optional<Clock::duration> surface_delay() const { return surface_delay_; }

 private:
  struct Frame {
    std::uint64_t sequence = 0;
    Clock::time_point arrived, done;
    bool is_shown = false;  // points show it
  };
  std::deque<Frame> frames_;
  std::optional<Clock::duration> points_delay_, surface_delay_;
};

}  // namespace hermite::server
