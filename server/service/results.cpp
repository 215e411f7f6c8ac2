#include "server/service/results.h"

#include <utility>

#include "core/output/ply.h"
#include "core/report/run_report.h"

namespace hermite {

Result<RunResults> write_results(const std::string& folder, Pipeline& pipeline, const Options& options, const Trajectory& groundtruth) {
  Result<Cloud> cloud = pipeline.cloud();
  if (!cloud.ok()) return in_context("reading the cloud", cloud.error());
  RunReport run;
  run.statistics = pipeline.statistics();
  run.options = options;
  run.trajectory_text = format_tum_trajectory(pipeline.trajectory());
  run.cloud_ply = format_ply(*cloud);
  RunResults results;
  results.report_json = format_report_json(run, pipeline.trajectory(), groundtruth);
  results.trajectory_text = run.trajectory_text;
  const std::pair<const char*, const std::string*> files[] = {
      {"cloud.ply", &run.cloud_ply}, {"trajectory.txt", &run.trajectory_text}, {"report.json", &results.report_json}};
  for (const auto& [name, bytes] : files)
    if (Status status = write_file_atomically(folder + "/" + name, *bytes); !status.ok())
      return in_context(std::string("writing ") + name, status.error());
  return results;
}

}  // namespace hermite
