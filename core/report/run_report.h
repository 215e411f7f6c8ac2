// report.json describes a run and its results. `hermite reconstruct` and scans on the server write
// the same keys.
#pragma once

#include <cstdint>
#include <string>

#include "core/pipeline/pipeline.h"

namespace hermite::report {

// Keys: frames, tracked_frames, weak_frames (included in tracked_frames), torn_frames (of which
// only a part was new), position_sigma_m and rotation_sigma_deg (of the last tracked frame),
// expected_error (ExpectedError, path_m, step_m, drift_m, stall_m, doubt_m and camera_m, if there
// is one), up (report_up, if an accelerometer measured it) or up_problem (text, why its values
// cannot be used), calibration_doubt and camera_correction (text, may be empty), corrected_camera
// (as in camera.json, if there is one), known_camera (the camera in use with what may still be
// wrong with it, for the next scan of the same device), surfels (of the whole map), cloud_points
// (of these, the ones in cloud.ply), mean_frame_ms, stages_ms, gpu_passes_ms, peak_rss_mb (of the
// process), gpu_memory_mb, gpu_memory_by_purpose_mb, device, settings, trajectory_sha256,
// cloud_sha256 and, with a ground truth, groundtruth_matched_frames, ate_rmse_m, ate_max_m,
// rpe_translation_rmse_m, rpe_rotation_rmse_deg, or groundtruth_problem (text) when the two cannot
// be compared. MB are 1e6 bytes. Hashes are of the exact bytes of trajectory.txt and cloud.ply.
struct RunReport {
  pipeline::PipelineStatistics statistics;
  pipeline::Options options;
  std::string trajectory_text;  // format_tum_trajectory
  std::string cloud_ply;        // format_ply
  std::uint64_t cloud_points = 0;
};
std::string format_report_json(const RunReport& report, const dataset::Trajectory& estimate,
                               const dataset::Trajectory& groundtruth);

}  // namespace hermite::report
