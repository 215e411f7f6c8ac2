// The frames of a running scan by their numbers: how many were received, handled and are on disk,
// and how many its camera may send. The server's counterpart of server/client/sent_frames.h. Uses
// no socket, disk or clock. A value that belongs to one thread.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/result.h"
#include "proto/wire/messages.h"

namespace hermite::server {

// 3.7 hours at 30 Hz; bounds trajectory and report.
inline constexpr std::uint64_t kMaxFramesPerScan = 400'000;
// So that six decimals are exact to a few microseconds.
inline constexpr double kMaxTimestamp_s = 1e11;

struct FrameCounts {
  std::uint64_t received = 0;   // valid messages
  std::uint64_t processed = 0;  // by the pipeline
  std::uint64_t dropped = 0;    // in live mode for a newer frame, or refused for their timestamp
};

// The part of a scan that an earlier server received, from its frame log.
struct ScanPast {
  std::uint64_t received = 0;  // frames, including refused ones
  std::uint64_t refused = 0;
  std::optional<double> last_timestamp_s;
  bool finished = false;  // all frames were received
};

class ReceivedFrames {
 public:
  // `credit_window`: how many frames the camera may send beyond those that were handled and are on
  // disk. `expected_count`: how many frames the scan will have; 0: unknown.
  ReceivedFrames(std::uint32_t credit_window, std::uint64_t expected_count, const ScanPast& past);

  // Counts the frame with that number. Errors, after which it is not counted, mean that the camera
  // has violated the protocol: kInvalidArgument for the order or the credit, kTooLarge beyond
  // kMaxFramesPerScan.
  Status receive(std::uint64_t sequence);

  // Takes the timestamp of the frame that was just received. kInvalidArgument: it is not a usable
  // number or not after the one before, so that the frame counts as dropped.
  Status take_timestamp(double timestamp_s);

  void processed() { ++counts_.processed; }  // one frame
  void dropped() { ++counts_.dropped; }      // one frame
  void restored(std::uint64_t processed_count, std::uint64_t dropped_count);
  void durable(std::uint64_t count) { durable_ = count; }  // the first `count` frames are on disk

  // Every frame that was handled in any way and is on disk returns one credit. So the camera, which
  // keeps frames until they are durable, never keeps more than its window.
  std::uint64_t granted() const;
  wire::Credit credit() const { return {granted(), durable_}; }
  bool camera_may_send() const { return counts_.received < granted(); }
  // The part of the window that no frame occupies, whether its frames are on disk or not.
  std::uint64_t free_window() const { return handled() + credit_window_ - counts_.received; }

  const FrameCounts& counts() const { return counts_; }
  // Frames 0 to this one (exclusive) can be read from the log.
  std::uint64_t durable_count() const { return durable_; }
  // Expected frames that were not handled yet. None if their number is unknown.
  std::optional<std::uint64_t> remaining_count() const;

 private:
  std::uint64_t handled() const { return counts_.processed + counts_.dropped; }

  const std::uint32_t credit_window_;  // frames
  const std::uint64_t expected_count_;
  FrameCounts counts_;
  std::uint64_t durable_ = 0;
  std::optional<double> last_timestamp_s_;
};

}  // namespace hermite::server
