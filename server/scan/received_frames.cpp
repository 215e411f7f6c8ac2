#include "server/scan/received_frames.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace hermite::server {

namespace {

Error broken_rule(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

}  // namespace

ReceivedFrames::ReceivedFrames(std::uint32_t credit_window, std::uint64_t expected_count,
                               const ScanPast& past)
    : credit_window_(credit_window),
      expected_count_(expected_count),
      counts_{past.received, 0, past.refused},
      durable_(past.received),
      last_timestamp_s_(past.last_timestamp_s) {}

Status ReceivedFrames::receive(std::uint64_t sequence) {
  if (sequence != counts_.received)
    return broken_rule(fmt::format(
        "frame.sequence is {}, expected is {}: frames are numbered 0, 1, 2, ... without gaps",
        sequence, counts_.received));
  if (!camera_may_send())
    return broken_rule(fmt::format("frame {} came without credit: granted are {} frames in all",
                                   sequence, granted()));
  if (counts_.received >= kMaxFramesPerScan)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("a scan has at most {} frames", kMaxFramesPerScan)};
  ++counts_.received;
  return Done{};
}

Status ReceivedFrames::take_timestamp(double timestamp_s) {
  const bool usable = std::isfinite(timestamp_s) && std::abs(timestamp_s) <= kMaxTimestamp_s;
  if (usable && (!last_timestamp_s_ || timestamp_s > *last_timestamp_s_)) {
    last_timestamp_s_ = timestamp_s;
    return Done{};
  }
  dropped();
  if (!usable) return broken_rule("frame.timestamp_s is not a finite number of at most 1e11 s");
  return broken_rule(fmt::format("frame.timestamp_s is {:f}, not after {:f} of the frame before",
                                 timestamp_s, *last_timestamp_s_));
}

void ReceivedFrames::restored(std::uint64_t processed_count, std::uint64_t dropped_count) {
  counts_.processed += processed_count;
  counts_.dropped += dropped_count;
}

std::uint64_t ReceivedFrames::granted() const {
  return std::min(handled(), durable_) + credit_window_;
}

std::optional<std::uint64_t> ReceivedFrames::remaining_count() const {
  if (expected_count_ == 0) return std::nullopt;
  return expected_count_ > handled() ? expected_count_ - handled() : 0;
}

}  // namespace hermite::server
