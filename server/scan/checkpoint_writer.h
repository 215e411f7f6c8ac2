// Writes the checkpoints of one scan beside its work: when one is due, and compressing and storing it on another thread. At most one is
// under way. Whatever goes wrong is a line in the log and no more: the frame log has everything.
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

namespace hermite {

// How many frames of a scan are on disk, told by one thread and awaited by another.
class DurableFrames {
 public:
  explicit DurableFrames(std::uint64_t count) : count_(count) {}
  void advance(std::uint64_t count);
  bool wait_for(std::uint64_t count, std::chrono::milliseconds patience);  // false: they were not in time

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t count_;
};

// Call from one thread, that of the scan.
class CheckpointWriter {
 public:
  using Clock = std::chrono::steady_clock;

  // `blobs` and `durable` outlive this. Period 0: never.
  CheckpointWriter(Blobs& blobs, std::string scan_id, std::chrono::milliseconds period, DurableFrames& durable);

  bool is_on() const { return period_.count() > 0; }

  // The period has passed, and so much time that what the last one took of this thread is a small part of it; none is under way.
  bool is_due(Clock::time_point now) const;

  // Stores it once its records are durable. `began`: when this thread started to make it. Waits for one that is under way.
  void write(ScanCheckpoint checkpoint, Clock::time_point began);

  void wait();  // for what is under way

 private:
  Result<std::size_t> store(const ScanCheckpoint& checkpoint, std::uint64_t frames);

  Blobs& blobs_;
  const std::string scan_id_;
  const std::chrono::milliseconds period_;
  DurableFrames& durable_;
  Clock::time_point next_;
  std::future<void> writing_;  // last: its destructor waits for what uses the others
};

}  // namespace hermite
