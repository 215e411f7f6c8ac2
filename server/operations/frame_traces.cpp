#include "server/operations/frame_traces.h"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

#include "core/base/chrome_trace.h"

namespace hermite::server {

namespace {

// Assigns overlapping spans of a stage, as those of waiting frames, to parallel tracks.
class Tracks {
 public:
  struct Place {
    int track = 0;
    bool is_new = false;
  };
  Place place(const Timeline::Stage& stage) {
    const auto end =
        stage.start + std::chrono::duration_cast<Timeline::Clock::duration>(
                          std::chrono::duration<double, std::milli>(stage.duration_ms));
    std::vector<Lane>& lanes = lanes_[stage.name];
    for (Lane& lane : lanes) {
      if (lane.free_from > stage.start) continue;
      lane.free_from = end;
      return {lane.track, false};
    }
    lanes.push_back({++count_, end});
    return {count_, true};
  }

 private:
  struct Lane {
    int track = 0;
    Timeline::Clock::time_point free_from;
  };
  std::map<std::string, std::vector<Lane>> lanes_;
  int count_ = 0;
};

}  // namespace

void FrameTraces::add(const std::string& scan_id, std::uint64_t sequence,
                      const std::vector<Timeline::Stage>& stages) {
  if (stages.empty()) return;
  if (scans_.size() >= kMaxTracedScans && !scans_.contains(scan_id)) {
    const auto silent =
        std::min_element(scans_.begin(), scans_.end(), [](const auto& a, const auto& b) {
          return a.second.back().stage.start < b.second.back().stage.start;
        });
    scans_.erase(silent);
  }
  std::deque<Span>& spans = scans_[scan_id];
  for (const Timeline::Stage& stage : stages) spans.push_back({stage, sequence});
  const Timeline::Clock::time_point oldest = stages.back().start - kTraceMemory;
  while (spans.size() > kMaxTracedSpans || (spans.size() > 1 && spans.front().stage.start < oldest))
    spans.pop_front();
}

Result<std::string> FrameTraces::chrome_json(const std::string& scan_id) const {
  const auto found = scans_.find(scan_id);
  if (found == scans_.end())
    return Error{ErrorCode::kNotFound,
                 "no frame of a scan with this id was seen in this run of the server"};
  std::ostringstream out;
  Timeline::Clock::time_point zero = found->second.front().stage.start;
  for (const Span& span : found->second) zero = std::min(zero, span.stage.start);
  ChromeTrace trace(out, zero);
  trace.name_process("scan " + scan_id);
  Tracks tracks;
  for (const Span& span : found->second) {
    const auto [track, is_new] = tracks.place(span.stage);
    if (is_new) trace.name_track(track, span.stage.name);
    trace.add({span.stage.name, "stage", track, span.stage.start, span.stage.duration_ms,
               fmt::format("{{\"frame\":{}}}", span.sequence)});
  }
  trace.finish();
  return out.str();
}

}  // namespace hermite::server
