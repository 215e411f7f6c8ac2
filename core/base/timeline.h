// What ran when, for benchmarks and traces. Whoever is given one appends to it and never reads it; where none is given nothing is noted.
// Plain value; one thread at a time.
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
    double duration_ms = 0;  // wall clock
  };
  // One command of the GPU. The clocks of host and GPU have no common zero: `start` is GPU time since the first command of the submission,
  // added to the host's time of submitting. So passes are drawn early by what the driver takes to begin, the same for all of a submission.
  struct Pass {
    std::string name;  // as in gpu::Device::PassTime
    Clock::time_point start;
    double duration_ms = 0;                // 0 where the device has no time stamps
    std::uint64_t invocations = 0;         // asked for; 0 of fills, copies and where the GPU decided
    std::uint64_t bytes_within_reach = 0;  // of all buffers bound; what is filled; what is copied, read and written
  };

  std::vector<Stage> stages;
  std::vector<Pass> passes;
};

}  // namespace hermite
