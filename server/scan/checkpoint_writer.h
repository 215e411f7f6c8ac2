// Writes the checkpoints of one scan while it runs: decides when one is due, and compresses and
// stores it on another thread, one at a time. Errors are only logged, since the frame log has
// everything.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <future>
#include <mutex>
#include <string>

#include "core/base/result.h"
#include "server/scan/checkpoint_file.h"
#include "server/store/blobs.h"

namespace hermite::server {

// The number of frames that are on disk, set by one thread and awaited by another.
class DurableFrames {
 public:
  explicit DurableFrames(std::uint64_t count) : count_(count) {}
  void advance(std::uint64_t count);
  bool wait_for(std::uint64_t count, std::chrono::milliseconds patience);  // false: timed out

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t count_;
};

// Used by one thread, that of the scan.
class CheckpointWriter {
 public:
  using Clock = std::chrono::steady_clock;

  // `blobs` and `durable` outlive this. Period 0: never.
  CheckpointWriter(Blobs& blobs, std::string scan_id, std::chrono::milliseconds period,
                   DurableFrames& durable);

  bool is_on() const { return period_.count() > 0; }

  // Whether the period has passed, the last checkpoint took only a small part of this thread's time
  // since, and none is being written.
  bool is_due(Clock::time_point now) const;

  // Stores it once its records are durable. `began`: when this thread started to make it. Waits for
  // a write in progress.
  void write(ScanCheckpoint checkpoint, Clock::time_point began);

  void wait();  // for a write in progress

 private:
  Result<std::size_t> store(const ScanCheckpoint& checkpoint, std::uint64_t frames);

  Blobs& blobs_;
  const std::string scan_id_;
  const std::chrono::milliseconds period_;
  DurableFrames& durable_;
  Clock::time_point next_;
  // Last member: its destructor waits for the task, which uses the others.
  std::future<void> writing_;
};

}  // namespace hermite::server
