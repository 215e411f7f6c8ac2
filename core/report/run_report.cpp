#include "core/report/run_report.h"

#include <sys/resource.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/dataset/camera_file.h"
#include "core/digest/sha256.h"
#include "core/evaluate/accuracy_report.h"
#include "core/report/reported_up.h"

namespace hermite::report {

namespace {

using Json = nlohmann::ordered_json;  // keeps the order of writing, for readers

constexpr double kMegabyte = 1e6;

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / kMegabyte;  // Linux reports KiB
}

// Converts texts of numbers and booleans, so that readers need no second parser.
Json setting_value(const std::string& text) {
  Json value = Json::parse(text, nullptr, false);
  return value.is_number() || value.is_boolean() ? value : Json(text);
}

}  // namespace

std::string format_report_json(const RunReport& run, const dataset::Trajectory& estimate,
                               const dataset::Trajectory& groundtruth) {
  const pipeline::PipelineStatistics& statistics = run.statistics;
  Json report;
  report["frames"] = statistics.frame_count;
  report["tracked_frames"] = statistics.tracked_frame_count;
  report["weak_frames"] = statistics.weak_frame_count;
  report["torn_frames"] = statistics.torn_frame_count;
  report["position_sigma_m"] = statistics.position_sigma_m;
  report["rotation_sigma_deg"] = statistics.rotation_sigma_rad * 180 / M_PI;
  if (const std::optional<track::ExpectedError>& error = statistics.expected_error)
    report["expected_error"] = {{"path_m", error->path_m},   {"step_m", error->step_m},
                                {"drift_m", error->drift_m}, {"stall_m", error->stall_m},
                                {"doubt_m", error->doubt_m}, {"camera_m", error->camera_m}};
  if (statistics.up) report_up(*statistics.up, report);
  if (!statistics.up_problem.empty()) report["up_problem"] = statistics.up_problem;
  report["calibration_doubt"] = statistics.calibration_doubt;
  report["camera_correction"] = statistics.camera_correction;
  const auto put_camera = [&report](const char* key, const Camera& camera) {
    report[key] = Json::parse(dataset::format_camera_json({camera}));
    report[key].erase("frame_rate_hz");  // unknown here
  };
  if (statistics.corrected_camera) put_camera("corrected_camera", *statistics.corrected_camera);
  put_camera("known_camera", statistics.known_camera);
  report["surfels"] = statistics.surfel_count;
  report["cloud_points"] = run.cloud_points;
  if (statistics.mapping)
    for (const adjust::MappingCountName& named : adjust::kMappingCountNames)
      report["mapping"][std::string(named.name)] = *statistics.mapping.*named.count;
  report["mean_frame_ms"] = statistics.mean_frame_ms;
  report["stages_ms"] = Json::object();
  for (const auto& [stage, ms] : statistics.stages_ms) report["stages_ms"][stage] = ms;
  report["gpu_passes_ms"] = Json::object();
  for (const auto& [pass, ms] : statistics.gpu_passes_ms) report["gpu_passes_ms"][pass] = ms;
  report["peak_rss_mb"] = peak_rss_mb();
  double gpu_bytes = 0;
  Json by_purpose = Json::object();
  for (const auto& [purpose, bytes] : statistics.gpu_memory_bytes) {
    gpu_bytes += static_cast<double>(bytes);
    by_purpose[purpose] = static_cast<double>(bytes) / kMegabyte;
  }
  report["gpu_memory_mb"] = gpu_bytes / kMegabyte;
  report["gpu_memory_by_purpose_mb"] = by_purpose;
  report["host_memory_mb"] = static_cast<double>(statistics.host_memory_bytes) / kMegabyte;
  report["device"] = statistics.device;
  report["settings"] = Json::object();
  for (const pipeline::Setting& setting : pipeline::list_settings(run.options))
    report["settings"][setting.key] = setting_value(setting.value);
  report["trajectory_sha256"] = digest::sha256_hex(run.trajectory_text);
  report["cloud_sha256"] = digest::sha256_hex(run.cloud_ply);
  return *evaluate::add_accuracy(report.dump(2, ' ', false, Json::error_handler_t::replace),
                                 estimate, groundtruth);
}

}  // namespace hermite::report
