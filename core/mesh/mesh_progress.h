// How long-running work on a mesh reports its progress and can be stopped.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>

namespace hermite::mesh {

// Called from time to time with the fraction that is done, 0 to 1, by any working thread, one at a
// time. Returns false to stop the work.
using MeshProgress = std::function<bool(double done)>;

// Counts finished pieces of work and reports them; after a stop nothing more is reported.
// Thread-safe.
class ToldProgress {
 public:
  ToldProgress(const MeshProgress& progress, std::size_t count)
      : progress_(progress), count_(count) {}

  bool stopped() const { return stopped_; }
  void add_one() {
    const std::lock_guard lock(mutex_);
    ++done_;
    if (progress_ && !stopped_ &&
        !progress_(static_cast<double>(done_) / static_cast<double>(count_)))
      stopped_ = true;
  }

 private:
  const MeshProgress& progress_;
  const std::size_t count_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::atomic<bool> stopped_ = false;
};

}  // namespace hermite::mesh
