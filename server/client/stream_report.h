// What the user of stream_frames() is told of a scan meanwhile: its counts so far, and messages
// about frames and the link. Belongs to one thread.
#pragma once

#include <cstdint>
#include <string>

#include "server/client/stream.h"

namespace hermite::client {

struct StreamReport {
  const StreamObserver& observer;  // outlives this
  StreamProgress progress;

  void tell_link(const std::string& message) const {
    if (observer.on_link) observer.on_link(message);
  }
  // About one frame, which is counted.
  void tell_problem(const std::string& message) {
    ++progress.problem_frames;
    if (observer.on_problem) observer.on_problem(message);
  }
};

}  // namespace hermite::client
