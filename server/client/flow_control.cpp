#include "server/client/flow_control.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"

namespace hermite {

void CreditWindow::grant_in_all(std::uint64_t frames_granted) { granted_ = std::max(granted_, frames_granted); }

void CreditWindow::take() {
  CHECK(available(), "a frame without credit");
  ++sent_;
}

FrameGate::FrameGate(const Pacing& pacing) : pacing_(pacing) {
  CHECK(!pacing.rate_hz || *pacing.rate_hz > 0, "a rate is positive");
  CHECK(!pacing.newest_wins || pacing.rate_hz, "a live camera has a rate");
}

SteadyTime FrameGate::due(std::uint64_t frame_number) const {
  if (!pacing_.rate_hz) return start_;
  const std::chrono::duration<double> after(static_cast<double>(frame_number) / *pacing_.rate_hz);
  return start_ + std::chrono::duration_cast<SteadyTime::duration>(after);
}

bool FrameGate::wants(SteadyTime now) const {
  if (!waiting_) return true;
  return pacing_.newest_wins && due(offered_count_) <= now;
}

void FrameGate::offer(EncodedFrame frame, SteadyTime now) {
  CHECK(wants(now), "the gate holds one frame");
  if (offered_count_ == 0) start_ = now;
  if (waiting_) ++dropped_count_;
  waiting_ = std::move(frame);
  ++offered_count_;
}

std::optional<EncodedFrame> FrameGate::take(SteadyTime now, bool has_credit) {
  if (!waiting_ || !has_credit || due(offered_count_ - 1) > now) return std::nullopt;
  return std::exchange(waiting_, std::nullopt);
}

std::optional<SteadyTime> FrameGate::next_event(SteadyTime now) const {
  if (!waiting_) return std::nullopt;
  const SteadyTime this_one = due(offered_count_ - 1);
  if (this_one > now) return this_one;
  const SteadyTime next_one = due(offered_count_);
  if (pacing_.newest_wins && next_one > now) return next_one;
  return std::nullopt;
}

}  // namespace hermite
