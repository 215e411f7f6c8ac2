#include "server/scan/frame_queue.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

namespace hermite::server {

struct FrameQueue::Impl {
  struct Waiting {
    wire::Frame frame;
    std::chrono::steady_clock::time_point since;
    std::size_t bytes() const { return frame.depth.size() + frame.color.size(); }
  };

  const std::size_t capacity;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Waiting> frames;  // guarded by mutex, like the members below
  std::size_t bytes = 0;
  bool closed = false;
  bool discarded = false;

  explicit Impl(std::size_t frame_count) : capacity(frame_count) {}

  Waiting take_front() {
    Waiting front = std::move(frames.front());
    frames.pop_front();
    bytes -= front.bytes();
    return front;
  }
};

FrameQueue::FrameQueue(std::size_t capacity) : impl_(std::make_unique<Impl>(capacity)) {}
FrameQueue::~FrameQueue() = default;

std::optional<wire::Frame> FrameQueue::push(wire::Frame frame) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->closed) return frame;
  std::optional<wire::Frame> dropped;
  if (impl_->frames.size() >= impl_->capacity) dropped = impl_->take_front().frame;
  impl_->frames.push_back({std::move(frame), std::chrono::steady_clock::now()});
  impl_->bytes += impl_->frames.back().bytes();
  impl_->changed.notify_one();
  return dropped;
}

void FrameQueue::close(bool discard) {
  const std::lock_guard lock(impl_->mutex);
  impl_->closed = true;
  if (discard) {
    impl_->frames.clear();
    impl_->bytes = 0;
    impl_->discarded = true;
  }
  impl_->changed.notify_one();
}

bool FrameQueue::discarded() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->discarded;
}

FrameQueue::Popped FrameQueue::pop(std::chrono::milliseconds patience) {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait_for(lock, patience,
                          [this] { return impl_->closed || !impl_->frames.empty(); });
  if (impl_->frames.empty()) return {std::nullopt, impl_->closed};
  Impl::Waiting front = impl_->take_front();
  return {std::move(front.frame), false, front.since};
}

std::size_t FrameQueue::waiting_bytes() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->bytes;
}

}  // namespace hermite::server
