#include "server/client/flow_control.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"

namespace hermite::client {

void CreditWindow::grant_in_all(std::uint64_t frames_granted) {
  granted_ = std::max(granted_, frames_granted);
}

void CreditWindow::take() {
  CHECK(available(), "a frame without credit");
  ++sent_;
}

FrameGate::FrameGate(const Pacing& pacing) : pacing_(pacing) {
  CHECK(!pacing.rate_hz || *pacing.rate_hz > 0, "a rate is positive");
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
  const std::uint64_t number = offered_count_++;
  if (number % of_ >= kept_) {
    ++left_out_count_;
    return;
  }
  if (waiting_) ++dropped_count_;
  waiting_ = std::move(frame);
  waiting_number_ = number;
}

void FrameGate::keep(int kept, int of) {
  CHECK(pacing_.newest_wins && kept >= 1 && kept <= of, "a live camera keeps some of its frames");
  kept_ = static_cast<std::uint64_t>(kept);
  of_ = static_cast<std::uint64_t>(of);
}

void FrameGate::go_on(SteadyTime now) { start_ += now - std::min(now, due(offered_count_)); }

std::optional<EncodedFrame> FrameGate::take(SteadyTime now, bool has_credit) {
  if (!waiting_ || !has_credit || due(waiting_number_) > now) return std::nullopt;
  return std::exchange(waiting_, std::nullopt);
}

std::optional<SteadyTime> FrameGate::next_event(SteadyTime now) const {
  if (!waiting_) return std::nullopt;
  const SteadyTime this_one = due(waiting_number_);
  if (this_one > now) return this_one;
  const SteadyTime next_one = due(offered_count_);
  if (pacing_.newest_wins && next_one > now) return next_one;
  return std::nullopt;
}

}  // namespace hermite::client
