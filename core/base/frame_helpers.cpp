#include "core/base/frame_helpers.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

namespace hermite {

namespace {

// For all scans of the process.
constexpr std::size_t kMostThreads = 32;

struct Job {
  const std::size_t count;
  const std::function<void(std::size_t)>& work;
  std::atomic<std::size_t> next = 0;
  // Guarded by the mutex of the helpers.
  std::size_t helper_count = 0;
  std::exception_ptr failure;
};

class FrameHelpers {
 public:
  FrameHelpers() {
    const std::size_t processors = std::max<std::size_t>(std::thread::hardware_concurrency(), 1);
    try {
      for (std::size_t i = 1; i < std::min(processors, kMostThreads + 1); ++i)
        std::thread([this] { help(); }).detach();
    } catch (const std::system_error&) {
      // The process may have no more threads: it goes on with those that there are.
    }
  }

  void run(Job& job) {
    const std::size_t wanted = std::min(job.count - 1, kMostFrameHelpers);
    {
      const std::lock_guard lock(mutex_);
      open_.push_back(&job);
    }
    for (std::size_t i = 0; i < wanted; ++i) begun_.notify_one();
    do_pieces(job);
    std::unique_lock lock(mutex_);
    close(job);
    ended_.wait(lock, [&job] { return job.helper_count == 0; });
  }

 private:
  void help() {
    std::unique_lock lock(mutex_);
    while (true) {
      begun_.wait(lock, [this] { return !open_.empty(); });
      Job& job = *open_.front();
      if (++job.helper_count == kMostFrameHelpers) close(job);
      lock.unlock();
      do_pieces(job);
      lock.lock();
      close(job);
      if (--job.helper_count == 0) ended_.notify_all();
    }
  }

  void do_pieces(Job& job) {
    try {
      for (std::size_t i = job.next++; i < job.count; i = job.next++) job.work(i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!job.failure) job.failure = std::current_exception();
      job.next = job.count;
    }
  }

  // No further helper joins in. The mutex is held.
  void close(Job& job) { std::erase(open_, &job); }

  std::mutex mutex_;
  std::condition_variable begun_, ended_;
  std::deque<Job*> open_;
};

// Never destroyed, since helpers wait in it until the process ends.
FrameHelpers& helpers() {
  static FrameHelpers& all = *new FrameHelpers;
  return all;
}

}  // namespace

void in_parallel_of_frame(std::size_t count, const std::function<void(std::size_t)>& work) {
  if (count == 0) return;
  Job job{count, work, 0, 0, nullptr};
  helpers().run(job);
  if (job.failure) std::rethrow_exception(job.failure);
}

}  // namespace hermite
