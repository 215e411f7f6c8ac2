// One camera of a load test: streams one scan after the other, live, until the time is over.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>

#include "server/client/load_frames.h"
#include "server/client/load_scans.h"
#include "server/client/load_statistics.h"
#include "server/client/stream.h"

namespace hermite::client {

// How long a camera may take to finish its last scan once the time is over.
inline constexpr std::chrono::seconds kLoadEndPatience{120};

// When the cameras of a load test finish: when its time is over or the user interrupts it.
// Thread-safe, as `interrupt_count` must be.
class LoadClock {
 public:
  LoadClock(std::chrono::duration<double> time, std::function<int()> interrupt_count);
  SteadyTime began() const { return began_; }
  bool interrupted() const { return interrupt_count_() > 0; }
  // As StreamObserver::interrupt_count: 0 go on, 1 finish, 2 give up.
  int wish();

 private:
  const SteadyTime began_ = std::chrono::steady_clock::now();
  const SteadyTime over_at_;
  const std::function<int()> interrupt_count_;
  std::atomic<SteadyTime::rep> finishing_since_{0};  // 0: not yet
};

// What cameras and viewers do at the moment, for a line of progress.
struct LoadCounters {
  std::atomic<int> scanning{0}, waiting{0}, watching{0};
  std::atomic<std::uint64_t> answered{0};
};

// What the cameras of a load test share. The references must outlive them.
struct LoadCameras {
  // Its title is the beginning of the scans' titles; its pacing has a rate.
  const StreamRequest& request;
  LoadFrames& frames;
  LoadScans& scans;
  LoadClock& clock;
  LoadCounters& counters;
};

// Blocks until the time is over and the last scan has ended, at most kLoadEndPatience and some
// seconds later. `number`: of the camera, from 1. Begins `delay` after the beginning of the test. A
// camera that is refused or fails tries again after a pause (Backoff), unless the server would only
// say the same again: a wrong token, a wrong setting.
CameraLoad run_load_camera(const LoadCameras& shared, int number,
                           std::chrono::duration<double> delay);

}  // namespace hermite::client
