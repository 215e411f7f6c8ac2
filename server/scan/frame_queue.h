// Frames on their way from the network thread to the worker of their scan. Bounded by a count; what a frame may weigh is bounded by the
// connection's message limit.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>

#include "proto/wire/messages.h"

namespace hermite {

class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity);
  ~FrameQueue();
  FrameQueue(const FrameQueue&) = delete;
  FrameQueue& operator=(const FrameQueue&) = delete;

  // Never blocks. When the queue is full the oldest frame makes room and is returned; after close() the frame itself is.
  std::optional<wire::Frame> push(wire::Frame frame);

  // No frames any more; `discard` drops those that wait. May be called again, to discard after all.
  void close(bool discard);

  bool discarded() const;  // close(true) was called

  struct Popped {
    std::optional<wire::Frame> frame;
    bool closed = false;                            // and empty: there will never be another frame
    std::chrono::steady_clock::time_point since{};  // when the frame was pushed
  };
  // Blocks until there is a frame or the end, at most for `patience`.
  Popped pop(std::chrono::milliseconds patience);

  std::size_t waiting_bytes() const;  // of the images

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
