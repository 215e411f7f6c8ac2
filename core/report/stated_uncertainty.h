// Are the poses where they are said to be? Stated uncertainties (core/track/map_certainty.h) against a ground truth. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/report/frame_row.h"

namespace hermite {

// Of one frame, as it was stated when the frame came: later corrections do not count.
struct StatedError {
  double position_m = 0, rotation_rad = 0;
  // Mahalanobis distances: of position and rotation together (six numbers), and of the position alone (three).
  double pose_sigmas = 0, position_sigmas = 0;
};

// By row; none: lost, without a true pose within 20 ms, or the first of its part of the map, by which the true world is laid on the
// estimated one, and which is therefore exact.
std::vector<std::optional<StatedError>> stated_errors(const std::vector<FrameRow>& rows, const Trajectory& groundtruth);

// The squared Mahalanobis distance of six numbers is below this in 99 % of all cases.
inline constexpr double kRegion99 = 16.812;
// Frames called tracked must not be farther off, nor farther off than said.
inline constexpr double kWrong_m = 0.05, kWrongSigmas = 5;

struct StatedShare {
  std::int64_t frame_count = 0, inside_count = 0;            // with an error, and in the stated 99 % region
  std::int64_t tracked_count = 0, tracked_inside_count = 0;  // the same of frames called tracked
  std::int64_t tracked_wrong_count = 0;                      // of these more than kWrong_m or kWrongSigmas off
};
StatedShare share_inside(const std::vector<FrameRow>& rows, const std::vector<std::optional<StatedError>>& errors);

}  // namespace hermite
