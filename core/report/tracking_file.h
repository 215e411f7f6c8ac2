// tracking.txt: what became of each frame of a run, a line each in the order of trajectory.txt, and
// why to the end of the line, where there is a reason: "1.033333 tracked", "1.066667 lost too few
// points: the depth camera sees almost nothing". Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/pipeline/frame_result.h"
#include "core/pipeline/reason_table.h"

namespace hermite::report {

struct TimedStatus {
  double timestamp_s = 0;  // of trajectory.txt: to the microsecond
  track::TrackingStatus status = track::TrackingStatus::kLost;
  std::uint16_t reason = pipeline::kNoReason;
};

struct TrackingFile {
  std::vector<TimedStatus> frames;
  pipeline::ReasonTable reasons;
};

std::string format_tracking(const std::vector<pipeline::AnchoredPose>& poses,
                            const pipeline::ReasonTable& reasons);

// kCorruptData, naming the line. Files of earlier versions have no reasons.
Result<TrackingFile> parse_tracking(std::string_view text);

}  // namespace hermite::report
