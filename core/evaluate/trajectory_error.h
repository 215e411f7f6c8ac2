// Measures how far an estimated trajectory is from the true one: absolute (ATE) and relative (RPE)
// error as defined by the TUM benchmark (Sturm et al. 2012), after a rigid alignment without scale.
// Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/associate.h"
#include "core/dataset/trajectory.h"

namespace hermite::evaluate {

struct ErrorStatistics {
  double rmse = 0, mean = 0, median = 0, max = 0;
};

// Returns zeros for no values; the median of an even count is the mean of the middle two.
ErrorStatistics statistics_of(std::vector<double> values);

// Error of the motion over a fixed time: inverse(true motion) * estimated motion. Needs no
// alignment.
struct RelativeError {
  std::int64_t pair_count = 0;
  ErrorStatistics translation_m;
  ErrorStatistics rotation_deg;
};

// Error of one pose of the estimate that has a true one.
struct FrameError {
  // Index of the pose in the estimate; `hermite reconstruct` writes one per frame.
  std::int64_t index = 0;
  double timestamp_s = 0;  // of the estimate
  // After the alignment, which uses positions only: if they hardly spread, as with a camera that
  // only rotates, the angle is not meaningful.
  double translation_m = 0;
  double rotation_deg = 0;
  // Error of the motion since the previous pose of the estimate; nullopt if that has no true pose.
  struct Step {
    double translation_m = 0;
    double rotation_deg = 0;
  };
  std::optional<Step> step;
};

struct TrajectoryError {
  std::int64_t matched_count = 0;    // poses of the estimate with a true pose within the gap
  std::int64_t estimate_count = 0;   // poses of the estimate
  Rigid3 groundtruth_from_estimate;  // the alignment used: true world from the estimate's world
  ErrorStatistics ate_m;             // distance of matched positions after the alignment
  RelativeError per_frame;           // neighbouring frames of the estimate, both matched
  // Poses one second apart (within the gap); nullopt if the trajectory is shorter or has no such
  // pairs.
  std::optional<RelativeError> per_second;
  std::vector<FrameError> frames;  // one for each matched pose, in ascending order
};

// Poses are matched by time, nearest first, each used once, at most `max_gap_s` apart. The
// alignment is Horn's (Umeyama without scale) on the matched positions; if they do not determine
// the rotation (all on one line, or one point), any optimal one is taken, which does not affect
// ATE. kInvalidArgument when fewer than 3 poses match, a pose is not finite, or times are not
// ascending.
Result<TrajectoryError> trajectory_error(const dataset::Trajectory& estimate,
                                         const dataset::Trajectory& groundtruth,
                                         double max_gap_s = dataset::kMaxAssociationGap_s);

// Returns the target_from_source that minimises the squared distances of paired points; the arrays
// have the same length, at least 1.
Rigid3 align_points(const std::vector<Eigen::Vector3d>& target,
                    const std::vector<Eigen::Vector3d>& source);

// Returns one object with the keys matched_poses, estimate_poses, ate_{rmse,mean,median,max}_m,
// rpe_translation_{rmse,mean,median,max}_m, rpe_rotation_{...}_deg, and rpe_1s_translation_...,
// rpe_1s_rotation_... if there are such pairs; groundtruth_from_estimate as 16 numbers, row major.
std::string format_trajectory_error_json(const TrajectoryError& error);

// Returns a table with one line per frame below the header line, which is
//   index,timestamp_s,translation_error_m,rotation_error_deg,
//   step_translation_error_m,step_rotation_error_deg
// without the break; the last two fields are empty if there is no step. Six decimals for time and
// degrees, nine for metres.
std::string format_frame_errors_csv(const std::vector<FrameError>& frames);

}  // namespace hermite::evaluate
