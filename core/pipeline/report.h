// report.json: what a run was and how well it went. The same keys come from `hermite reconstruct` and from a scan on the server.
#pragma once

#include <string>

#include "core/pipeline/pipeline.h"

namespace hermite {

// Keys: frames, tracked_frames, surfels, mean_frame_ms, stages_ms, peak_rss_mb, gpu_memory_mb, device, settings, trajectory_sha256, cloud_sha256 and, with a
// ground truth, ate_rmse_m, ate_max_m, rpe_translation_rmse_m, rpe_rotation_rmse_deg. Hashes are of the exact bytes of trajectory.txt and cloud.ply.
struct RunReport {
  PipelineStatistics statistics;
  Options options;
  std::string trajectory_text;  // format_tum_trajectory
  std::string cloud_ply;        // format_ply
};
std::string format_report_json(const RunReport& report, const Trajectory& estimate, const Trajectory& groundtruth);

}  // namespace hermite
