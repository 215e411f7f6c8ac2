#include "core/evaluate/accuracy_report.h"

#include <nlohmann/json.hpp>

#include "core/evaluate/trajectory_error.h"

namespace hermite {

Result<std::string> add_accuracy(const std::string& report_json, const Trajectory& estimate, const Trajectory& groundtruth) {
  using Json = nlohmann::ordered_json;
  Json report = Json::parse(report_json, nullptr, /*allow_exceptions=*/false);
  if (!report.is_object()) return Error{ErrorCode::kCorruptData, "the report is not a JSON object"};
  const auto error = trajectory_error(estimate, groundtruth);
  if (!error.ok()) return in_context("accuracy against the ground truth", error.error());
  const Json accuracy = Json::parse(format_trajectory_error_json(*error));
  for (const auto& [key, value] : accuracy.items()) {
    if (key.starts_with("ate_") || key.starts_with("rpe_")) report[key] = value;
  }
  return report.dump(2);
}

}  // namespace hermite
