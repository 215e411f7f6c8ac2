// Makes items in order on a separate thread, a few ahead of the consumer.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/base/step_back.h"

namespace hermite {

template <class Item>
class ReadAhead {
 public:
  // Calls make(begin), ..., make(end - 1) in turn. At most `ahead` items wait. `make` must not
  // throw, and what it uses must outlive this object.
  ReadAhead(std::int64_t begin, std::int64_t end, std::size_t ahead,
            std::function<Item(std::int64_t)> make)
      : end_(end), ahead_(ahead), make_(std::move(make)), next_(begin), thread_([this, begin] {
          make_all(begin);
        }) {}

  // Waits for the item that is being made.
  ~ReadAhead() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  // Returns the items in order, std::nullopt after the last. Blocks until the next one is made.
  std::optional<Item> next() {
    std::unique_lock lock(mutex_);
    if (next_ >= end_) return std::nullopt;
    changed_.wait(lock, [this] { return !items_.empty(); });
    Item item = std::move(items_.front());
    items_.pop_front();
    ++next_;
    changed_.notify_all();
    return item;
  }

 private:
  void make_all(std::int64_t begin) {
    step_back();
    for (std::int64_t index = begin; index < end_; ++index) {
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return stop_ || items_.size() < ahead_; });
        if (stop_) return;
      }
      Item item = make_(index);
      const std::lock_guard lock(mutex_);
      items_.push_back(std::move(item));
      changed_.notify_all();
    }
  }

  const std::int64_t end_;
  const std::size_t ahead_;
  const std::function<Item(std::int64_t)> make_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;  // guarded by mutex_, like the next two
  std::int64_t next_;       // the next item to be taken
  bool stop_ = false;
  std::thread thread_;  // declared last because it uses the other members
};

}  // namespace hermite
