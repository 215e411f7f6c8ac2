// Records the processing stages of the frames of the last minute, by scan, for /debug/trace.
// Bounded: old spans are removed first, then the scans that were inactive for longest. One thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/timeline.h"

namespace hermite::server {

inline constexpr std::chrono::seconds kTraceMemory(60);
// Per scan: a minute at 30 Hz has some 16 000, of about 60 bytes.
inline constexpr std::size_t kMaxTracedSpans = 40'000;
// All that may run (64) and the last that have ended.
inline constexpr std::size_t kMaxTracedScans = 72;

class FrameTraces {
 public:
  // Adds completed stages of a frame. A stage that belongs to no frame (encoding for viewers) has
  // the number of the last one.
  void add(const std::string& scan_id, std::uint64_t sequence,
           const std::vector<Timeline::Stage>& stages);

  // Returns JSON for chrome://tracing, with one track per stage, or more if its spans overlap.
  // kNotFound: no such scan, or no longer recorded.
  Result<std::string> chrome_json(const std::string& scan_id) const;

 private:
  struct Span {
    Timeline::Stage stage;
    std::uint64_t sequence = 0;
  };
  std::map<std::string, std::deque<Span>> scans_;
};

}  // namespace hermite::server
