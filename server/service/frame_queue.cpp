#include "server/service/frame_queue.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

namespace hermite {

struct FrameQueue::Impl {
  const std::size_t capacity;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<wire::Frame> frames;  // guarded by mutex, as `closed`
  bool closed = false;
  bool discarded = false;

  explicit Impl(std::size_t frame_count) : capacity(frame_count) {}
};

FrameQueue::FrameQueue(std::size_t capacity) : impl_(std::make_unique<Impl>(capacity)) {}
FrameQueue::~FrameQueue() = default;

std::optional<wire::Frame> FrameQueue::push(wire::Frame frame) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->closed) return frame;
  std::optional<wire::Frame> dropped;
  if (impl_->frames.size() >= impl_->capacity) {
    dropped = std::move(impl_->frames.front());
    impl_->frames.pop_front();
  }
  impl_->frames.push_back(std::move(frame));
  impl_->changed.notify_one();
  return dropped;
}

void FrameQueue::close(bool discard) {
  const std::lock_guard lock(impl_->mutex);
  impl_->closed = true;
  if (discard) impl_->frames.clear();
  impl_->discarded = impl_->discarded || discard;
  impl_->changed.notify_one();
}

bool FrameQueue::discarded() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->discarded;
}

FrameQueue::Popped FrameQueue::pop(std::chrono::milliseconds patience) {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait_for(lock, patience, [this] { return impl_->closed || !impl_->frames.empty(); });
  if (impl_->frames.empty()) return {std::nullopt, impl_->closed};
  Popped popped{std::move(impl_->frames.front()), false};
  impl_->frames.pop_front();
  return popped;
}

}  // namespace hermite
