#include "server/scan/checkpoint_writer.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>
#include <utility>

namespace hermite::server {

namespace {

// Checkpoints may take one part in this many of a scan's time.
constexpr int kWorkPerCheckpoint = 50;

// The log is synced ten times a second: a disk that takes this long is failing.
constexpr std::chrono::seconds kDurablePatience(10);

}  // namespace

void DurableFrames::advance(std::uint64_t count) {
  {
    const std::lock_guard lock(mutex_);
    count_ = std::max(count_, count);
  }
  changed_.notify_all();
}

bool DurableFrames::wait_for(std::uint64_t count, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience, [&] { return count_ >= count; });
}

CheckpointWriter::CheckpointWriter(Blobs& blobs, std::string scan_id,
                                   std::chrono::milliseconds period, DurableFrames& durable)
    : blobs_(blobs),
      scan_id_(std::move(scan_id)),
      period_(period),
      durable_(durable),
      next_(Clock::now() + period) {}

bool CheckpointWriter::is_due(Clock::time_point now) const {
  const bool busy =
      writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  return is_on() && now >= next_ && !busy;
}

void CheckpointWriter::write(ScanCheckpoint checkpoint, Clock::time_point began) {
  wait();
  const Clock::time_point now = Clock::now();
  next_ = now + std::max<Clock::duration>(period_, kWorkPerCheckpoint * (now - began));
  writing_ = std::async(
      std::launch::async, [this, cost = now - began, checkpoint = std::move(checkpoint)] {
        const Clock::time_point start = Clock::now();
        const std::uint64_t frames = checkpoint.record_count - kRecordsBeforeFrames;
        const Result<std::size_t> bytes = store(checkpoint, frames);
        if (!bytes.ok())
          return spdlog::warn("scan {}: no checkpoint was written: {}", scan_id_,
                              bytes.error().message);
        const auto ms = [](Clock::duration time) {
          return std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
        };
        spdlog::debug(
            "scan {}: checkpoint of {} frames, {} kB of {} kB; {} ms of the scan's time, {} ms "
            "beside it",
            scan_id_, frames, *bytes / 1000, checkpoint.pipeline.size() / 1000, ms(cost),
            ms(Clock::now() - start));
      });
}

// Returns the size in bytes.
Result<std::size_t> CheckpointWriter::store(const ScanCheckpoint& checkpoint,
                                            std::uint64_t frames) try {
  const std::string bytes = format_checkpoint(checkpoint);
  if (!durable_.wait_for(frames, kDurablePatience))
    return Error{ErrorCode::kBusy, "its frames are not on disk yet"};
  if (Status stored = blobs_.put(scan_id_, kCheckpointName, bytes); !stored.ok())
    return stored.error();
  return bytes.size();
} catch (const std::bad_alloc&) {
  return Error{ErrorCode::kTooLarge, "there is no memory for it"};
}

void CheckpointWriter::wait() {
  if (writing_.valid()) writing_.get();
}

}  // namespace hermite::server
