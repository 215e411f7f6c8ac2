// Runs independent pieces of work on all processors.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace hermite {

// Calls work(i) once for every i below `count`, in no particular order, on the caller's thread and
// on helper threads that end with the call. `work` may only write data that belongs to i. If it
// throws, no further pieces are begun and the exception is rethrown when the running ones have
// ended; of several exceptions, the first one caught. Uses at most `thread_count` threads; 0: one
// per processor.
template <class Work>
void in_parallel(std::size_t count, int thread_count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto run = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> helpers;
    const std::size_t processors = std::max<std::size_t>(std::thread::hardware_concurrency(), 1);
    const std::size_t most = thread_count > 0 ? static_cast<std::size_t>(thread_count) : processors;
    while (helpers.size() + 1 < std::min(most, count)) helpers.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

template <class Work>
void in_parallel(std::size_t count, const Work& work) {
  in_parallel(count, 0, work);
}

}  // namespace hermite
