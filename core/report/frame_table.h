// What became of each frame of a run, for spreadsheets and scripts.
#pragma once

#include <string>
#include <vector>

#include "core/pipeline/pipeline.h"

namespace hermite {

struct FrameRow {
  FrameResult result;
  double ms = 0;  // wall clock inside Pipeline::process()
};

// CSV, a heading and one line a frame: frame, timestamp_s, status, event, correction_m, inlier_ratio, residual_rms_m, surfels, ms, reason.
// The reason is quoted; the pose is in the trajectory.
std::string format_frame_table(const std::vector<FrameRow>& rows);

}  // namespace hermite
