// The queue of frames from the network thread to the worker of a scan. Bounded by a count; the size
// of a frame is bounded by the message limit of the connection.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>

#include "proto/wire/messages.h"

namespace hermite::server {

class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity);
  ~FrameQueue();
  FrameQueue(const FrameQueue&) = delete;
  FrameQueue& operator=(const FrameQueue&) = delete;

  // Never blocks. When the queue is full the oldest frame is removed and returned; after close()
  // the new frame is returned.
  std::optional<wire::Frame> push(wire::Frame frame);

  // Accepts no more frames; `discard` also drops the waiting ones. May be called again to discard
  // later.
  void close(bool discard);

  bool discarded() const;  // close(true) was called

  struct Popped {
    std::optional<wire::Frame> frame;
    // Closed and empty: there will be no more frames.
    bool closed = false;
    std::chrono::steady_clock::time_point since{};  // when the frame was pushed
  };
  // Blocks until a frame or the end, at most for `patience`.
  Popped pop(std::chrono::milliseconds patience);

  std::size_t waiting_bytes() const;  // of the images of waiting frames

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite::server
