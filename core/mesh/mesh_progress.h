// How what works on a mesh tells how far it is, and is stopped.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>

namespace hermite {

// Called from time to time with the share that is done, on any of the threads that work, one at a time; false: stop.
using MeshProgress = std::function<bool(double done)>;

// Counts pieces of work that are done and tells it; after a "stop" no more. Thread-safe.
class ToldProgress {
 public:
  ToldProgress(const MeshProgress& progress, std::size_t count) : progress_(progress), count_(count) {}

  bool stopped() const { return stopped_; }
  void add_one() {
    const std::lock_guard lock(mutex_);
    ++done_;
    if (progress_ && !stopped_ && !progress_(static_cast<double>(done_) / static_cast<double>(count_))) stopped_ = true;
  }

 private:
  const MeshProgress& progress_;
  const std::size_t count_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::atomic<bool> stopped_ = false;
};

}  // namespace hermite
