// A load test of a server: cameras that stream a sequence live and viewers that watch them, all
// from this process.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "server/client/load_statistics.h"
#include "server/client/scans.h"
#include "server/client/stream.h"

namespace hermite::client {

inline constexpr int kMaxLoadCameras = 256;  // each has two threads
inline constexpr int kMaxLoadViewers = 10'000;
inline constexpr int kMaxLoadSeconds = 3600;  // every answer time is kept

struct LoadPlan {
  StreamRequest request;  // with its title; its pacing must have a rate and be live
  ApiTarget api;          // for removing the scans
  int cameras = 1, viewers = 0;
  std::chrono::duration<double> time{60};
  std::chrono::duration<double> ramp{0};  // camera i of n begins after ramp i / n, viewers likewise
  bool keep = false;                      // the scans
};

struct LoadProgress {
  std::int64_t prepared = 0, to_prepare = 0;  // frames, before the test begins; then both are 0
  double elapsed_s = 0;
  int scanning = 0, waiting = 0, watching = 0;  // now
  std::uint64_t answered = 0;
  bool finishing = false;  // the time is over: the last scans are being finished
};

struct LoadObserver {
  // Some times per second, one call at a time.
  std::function<void(const LoadProgress&)> on_progress;
  // 1: finish now. 2: give up. Thread-safe, never empty.
  std::function<int()> interrupt_count;
};

// Blocks until the time is over, the cameras have finished and the scans are removed. CHECKs the
// limits above. Whatever cameras and viewers met is in the result. Error: kTooLarge: more open
// files than the system allows.
Result<LoadResult> run_load(const dataset::Sequence& sequence, const LoadPlan& plan,
                            const LoadObserver& observer);

}  // namespace hermite::client
