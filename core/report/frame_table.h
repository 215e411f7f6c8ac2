// What became of each frame of a run, for spreadsheets and scripts.
#pragma once

#include <string>
#include <vector>

#include "core/report/frame_row.h"

namespace hermite {

// CSV, a heading and one line a frame: frame, timestamp_s, status, event, correction_m, inlier_ratio, residual_rms_m, surfels, ms, reason,
// position_sigma_m, rotation_sigma_deg (along the axes of the greatest errors), covariance (the upper triangle of
// PoseUncertainty::second_moment by rows, with spaces between), and with a ground truth position_error_m, rotation_error_deg and
// error_sigmas (the Mahalanobis distance of both) as they were when the frame came. The reason is quoted; the pose is in the trajectory.
std::string format_frame_table(const std::vector<FrameRow>& rows, const Trajectory& groundtruth = {});

}  // namespace hermite
