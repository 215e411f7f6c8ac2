// Records what ran when, for benchmarks and traces. Code that is given a timeline only appends to
// it; without one, nothing is recorded. Plain value; one thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace hermite {

struct Timeline {
  using Clock = std::chrono::steady_clock;

  struct Stage {
    std::string name;  // "track"
    Clock::time_point start;
    double duration_ms = 0;  // wall-clock time
  };
  // One command of the GPU. The clocks of host and GPU have no common zero: `start` is GPU time
  // since the first command of the submission, added to the host's time of submitting. So passes
  // are drawn too early by the driver's start-up delay, which is the same for all passes of a
  // submission.
  struct Pass {
    std::string name;  // as in gpu::Device::PassTime
    Clock::time_point start;
    double duration_ms = 0;  // 0 if the device has no time stamps
    // As requested; 0 for fills, copies and where the GPU determined the number.
    std::uint64_t invocations = 0;
    // Size of all bound buffers; of the filled range; or of the copied data, read and written.
    std::uint64_t bytes_within_reach = 0;
  };

  std::vector<Stage> stages;
  std::vector<Pass> passes;
};

}  // namespace hermite
