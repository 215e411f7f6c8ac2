// Comparison of stated pose uncertainties (core/track/pose_uncertainty.h) with a ground truth. Pure
// functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/report/frame_row.h"

namespace hermite::report {

// The error of one frame, as stated when the frame was processed; later corrections are not
// included.
struct StatedError {
  double position_m = 0, rotation_rad = 0;
  // Mahalanobis distances: of position and rotation together (six dimensions), and of the position
  // alone (three).
  double pose_sigmas = 0, position_sigmas = 0;
};

// Returns the error of each row. It is nullopt if the frame is lost, if there is no true pose
// within 20 ms, or for the first frame of a component, by which the true world is aligned with the
// estimated one and whose error is therefore zero.
std::vector<std::optional<StatedError>> stated_errors(const std::vector<FrameRow>& rows,
                                                      const dataset::Trajectory& groundtruth);

// A tracked frame counts as wrong if its error exceeds one of these.
inline constexpr double kWrong_m = 0.05, kWrongSigmas = 5;

struct StatedShare {
  // Frames with an error; of these, those inside the stated 99 % region.
  std::int64_t frame_count = 0, inside_count = 0;
  // The same for frames of status tracked.
  std::int64_t tracked_count = 0, tracked_inside_count = 0;
  // Of these, those with an error above kWrong_m or kWrongSigmas.
  std::int64_t tracked_wrong_count = 0;
};
StatedShare share_inside(const std::vector<FrameRow>& rows,
                         const std::vector<std::optional<StatedError>>& errors);

}  // namespace hermite::report
