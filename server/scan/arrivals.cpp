#include "server/scan/arrivals.h"

#include <algorithm>

namespace hermite::server {

void Arrivals::frame_done(std::uint64_t sequence, Clock::time_point arrived,
                          Clock::time_point now) {
  frames_.push_back({sequence, arrived, now});
  if (frames_.size() > kMostFrames) frames_.pop_front();
}

void Arrivals::points_encoded(Clock::time_point began, Clock::time_point now) {
  std::optional<Clock::time_point> oldest;
  for (Frame& frame : frames_) {
    if (frame.is_shown || frame.done > began) continue;
    frame.is_shown = true;
    oldest = std::min(oldest.value_or(frame.arrived), frame.arrived);
  }
  if (oldest) points_delay_ = now - *oldest;
}

std::optional<Arrivals::Clock::time_point> Arrivals::of(std::uint64_t sequence) const {
  const auto found = std::find_if(frames_.rbegin(), frames_.rend(), [sequence](const Frame& frame) {
    return frame.sequence == sequence;
  });
  return found == frames_.rend() ? std::nullopt : std::optional(found->arrived);
}

}  // namespace hermite::server
