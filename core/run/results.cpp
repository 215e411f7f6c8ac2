#include "core/run/results.h"

#include <utility>

#include "core/output/ply.h"
#include "core/report/run_report.h"
#include "core/report/tracking_file.h"
#include "core/thumbnail/thumbnail.h"

namespace hermite::run {

Result<RunResults> results_of(pipeline::Pipeline& pipeline, const pipeline::Options& options,
                              const dataset::Trajectory& groundtruth) {
  Result<output::Cloud> cloud = pipeline.cloud();
  if (!cloud.ok()) return in_context("reading the cloud", cloud.error());
  const Result<output::Cloud> surfels = pipeline.surfels();
  if (!surfels.ok()) return in_context("reading the surfels", surfels.error());
  report::RunReport run;
  run.statistics = pipeline.statistics();
  run.options = options;
  run.trajectory_text = dataset::format_tum_trajectory(pipeline.trajectory());
  run.cloud_ply = output::format_ply(*cloud);
  run.cloud_points = cloud->size();
  std::string report_json = report::format_report_json(run, pipeline.trajectory(), groundtruth);
  // Of a scan that was ended at once no point has been seen often enough.
  Result<std::string> thumbnail =
      thumbnail::thumbnail_jpeg(cloud->empty() ? *surfels : *cloud, run.statistics.up);
  if (!thumbnail.ok()) return in_context("drawing the thumbnail", thumbnail.error());
  return RunResults{std::move(run.cloud_ply),
                    output::format_ply(*surfels),
                    std::move(run.trajectory_text),
                    report::format_tracking(pipeline.anchored_poses(), pipeline.reasons()),
                    *std::move(thumbnail),
                    std::move(report_json)};
}

std::array<ResultFile, 6> files_of(const RunResults& results) {
  return {{{"cloud.ply", results.cloud_ply},
           {"surfels.ply", results.surfels_ply},
           {"trajectory.txt", results.trajectory_text},
           {"tracking.txt", results.tracking_text},
           {thumbnail::kThumbnailName, results.thumbnail_jpeg},
           {"report.json", results.report_json}}};
}

std::uint64_t room_for_results(std::uint64_t surfel_count, std::uint64_t frame_count) {
  // A surfel takes 51 bytes in surfels.ply, another 51 in cloud.ply if it is stable, and a measured
  // 13 in the chunks; a frame takes 99 in the trajectory and 27 in the file of its tracking status,
  // without the reason.
  constexpr std::uint64_t kBytesPerSurfel = 2 * 51 + 13,
                          kBytesPerFrame = 160 + pipeline::kMaxReasonBytes,
                          kBytesAtLeast = 1'000'000;
  return kBytesAtLeast + kBytesPerSurfel * surfel_count + kBytesPerFrame * frame_count;
}

}  // namespace hermite::run
