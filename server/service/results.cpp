#include "server/service/results.h"

#include <utility>

#include "core/output/ply.h"
#include "core/report/run_report.h"

namespace hermite {

Result<RunResults> results_of(Pipeline& pipeline, const Options& options, const Trajectory& groundtruth) {
  Result<Cloud> cloud = pipeline.cloud();
  if (!cloud.ok()) return in_context("reading the cloud", cloud.error());
  const Result<Cloud> surfels = pipeline.surfels();
  if (!surfels.ok()) return in_context("reading the surfels", surfels.error());
  RunReport run;
  run.statistics = pipeline.statistics();
  run.options = options;
  run.trajectory_text = format_tum_trajectory(pipeline.trajectory());
  run.cloud_ply = format_ply(*cloud);
  run.cloud_points = cloud->size();
  std::string report_json = format_report_json(run, pipeline.trajectory(), groundtruth);
  return RunResults{std::move(run.cloud_ply), format_ply(*surfels), std::move(run.trajectory_text), std::move(report_json)};
}

std::array<ResultFile, 4> files_of(const RunResults& results) {
  return {{{"cloud.ply", results.cloud_ply},
           {"surfels.ply", results.surfels_ply},
           {"trajectory.txt", results.trajectory_text},
           {"report.json", results.report_json}}};
}

}  // namespace hermite
