#include "server/client/load_answers.h"

#include <algorithm>
#include <cmath>

namespace hermite::client {

namespace {

// More than any server grants (OutgoingFrames keeps at most 256): one that grants more without ever
// answering must not exhaust the memory.
constexpr std::size_t kMaxUnanswered = 4096;

}  // namespace

void AnswerTimes::see(const StreamProgress& progress, SteadyTime now) {
  for (; sent_count_ < progress.sent_frames; ++sent_count_) {
    waiting_.push_back({sent_count_, last_seen_.value_or(now)});
    if (waiting_.size() > kMaxUnanswered) waiting_.pop_front();
  }
  last_seen_ = now;
  if (!progress.last_result || progress.last_result->sequence < next_result_) return;
  const std::uint64_t answered = progress.last_result->sequence;
  next_result_ = answered + 1;
  // Results come in order: the server has dropped the frames before this one.
  while (!waiting_.empty() && waiting_.front().sequence < answered) waiting_.pop_front();
  if (waiting_.empty() || waiting_.front().sequence != answered) return;
  times_ms_.push_back(std::chrono::duration<float, std::milli>(now - waiting_.front().at).count());
  waiting_.pop_front();
}

void OfferedFrames::see(const StreamProgress& progress, SteadyTime now) {
  offered_ = progress.sent_frames + progress.dropped_frames + progress.left_out_frames;
  if (!first_at_ && offered_ > 0) first_at_ = now;
  if (first_at_ && !progress.finishing) {
    const double elapsed_s = std::chrono::duration<double>(now - *first_at_).count();
    due_ = static_cast<std::uint64_t>(std::floor(elapsed_s * rate_hz_)) + 1;
    if (progress.frame_count > 0)
      due_ = std::min(due_, static_cast<std::uint64_t>(progress.frame_count));
  }
  due_ = std::max(due_, offered_);
}

}  // namespace hermite::client
