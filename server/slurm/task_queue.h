// Functions that other threads leave for one thread to run. Header only.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <utility>

namespace hermite::server {

// push() and close() on any thread; run_some() on the one thread that runs the functions. What is
// left when this is destroyed is never run.
class TaskQueue {
 public:
  void push(std::function<void()> action) {
    {
      const std::lock_guard lock(mutex_);
      actions_.push_back(std::move(action));
    }
    changed_.notify_one();
  }

  // Ends a wait in run_some(), now and from now on.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_one();
  }

  // Waits for the first function at most so long, and runs all that are there.
  void run_some(std::chrono::milliseconds patience) {
    std::deque<std::function<void()>> now;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, patience, [this] { return closed_ || !actions_.empty(); });
      now.swap(actions_);
    }
    for (std::function<void()>& action : now) std::exchange(action, nullptr)();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> actions_;
  bool closed_ = false;
};

}  // namespace hermite::server
