// What the server did with the frames of the last minute, scan by scan, kept for /debug/trace. Bounded: old spans go, then the scans that
// were silent for longest. One thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/timeline.h"

namespace hermite {

inline constexpr std::chrono::seconds kTraceMemory(60);
inline constexpr std::size_t kMaxTracedSpans = 40'000;  // of a scan: a minute at 30 Hz has some 16 000, of about 60 bytes
inline constexpr std::size_t kMaxTracedScans = 72;      // all that may run (64) and the last that have ended

class FrameTraces {
 public:
  // Stages of the frame with that number, as they ended; a stage of no frame (encoding for viewers) has the last one's.
  void add(const std::string& scan_id, std::uint64_t sequence, const std::vector<Timeline::Stage>& stages);

  // For chrome://tracing, one track for each stage, or more where its spans overlap. kNotFound: no such scan, or a forgotten one.
  Result<std::string> chrome_json(const std::string& scan_id) const;

 private:
  struct Span {
    Timeline::Stage stage;
    std::uint64_t sequence = 0;
  };
  std::map<std::string, std::deque<Span>> scans_;
};

}  // namespace hermite
