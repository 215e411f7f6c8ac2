// tracking.txt: what became of each frame of a run, a line each in the order of trajectory.txt: "1.033333 tracked". Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/pipeline/frame_result.h"

namespace hermite {

struct TimedStatus {
  double timestamp_s = 0;  // of trajectory.txt: to the microsecond
  TrackingStatus status = TrackingStatus::kLost;
};

std::string format_tracking(const std::vector<AnchoredPose>& poses);

// kCorruptData, naming the line.
Result<std::vector<TimedStatus>> parse_tracking(std::string_view text);

}  // namespace hermite
