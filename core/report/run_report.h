// report.json: what a run was and how well it went. The same keys come from `hermite reconstruct` and from a scan on the server.
#pragma once

#include <cstdint>
#include <string>

#include "core/pipeline/pipeline.h"

namespace hermite {

// Keys: frames, tracked_frames, weak_frames (of the tracked ones), position_sigma_m and rotation_sigma_deg (of the
// last tracked frame), calibration_doubt and camera_correction (in words, may be empty), corrected_camera (as camera.json has it, where
// there is one), surfels (all of the map), cloud_points (of those the ones that cloud.ply has), mean_frame_ms, stages_ms, gpu_passes_ms,
// peak_rss_mb (of the process), gpu_memory_mb, gpu_memory_by_purpose_mb, device, settings, trajectory_sha256, cloud_sha256 and, with a
// ground truth, groundtruth_matched_frames, ate_rmse_m, ate_max_m, rpe_translation_rmse_m, rpe_rotation_rmse_deg, or groundtruth_problem in
// words when the two cannot be compared. MB are 1e6 bytes. Hashes are of the exact bytes of trajectory.txt and cloud.ply.
struct RunReport {
  PipelineStatistics statistics;
  Options options;
  std::string trajectory_text;  // format_tum_trajectory
  std::string cloud_ply;        // format_ply
  std::uint64_t cloud_points = 0;
};
std::string format_report_json(const RunReport& report, const Trajectory& estimate, const Trajectory& groundtruth);

}  // namespace hermite
