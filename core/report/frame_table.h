// The results of all frames of a run as a table for spreadsheets and scripts.
#pragma once

#include <string>
#include <vector>

#include "core/report/frame_row.h"

namespace hermite::report {

// Returns CSV with a header and one line per frame: frame, timestamp_s, status, event,
// correction_m, inlier_ratio, residual_rms_m, surfels, ms, reason, position_sigma_m,
// rotation_sigma_deg (both along the axes of the largest errors), covariance (the upper triangle of
// PoseUncertainty::second_moment by rows, separated by spaces), and with a ground truth
// position_error_m, rotation_error_deg and error_sigmas (the Mahalanobis distance of both) as they
// were when the frame was processed. The reason is quoted; the pose is in the trajectory.
std::string format_frame_table(const std::vector<FrameRow>& rows,
                               const dataset::Trajectory& groundtruth = {});

}  // namespace hermite::report
