#include "core/evaluate/accuracy_report.h"

#include <nlohmann/json.hpp>

#include "core/evaluate/trajectory_error.h"

namespace hermite::evaluate {

Result<std::string> add_accuracy(const std::string& report_json,
                                 const dataset::Trajectory& estimate,
                                 const dataset::Trajectory& groundtruth) {
  using Json = nlohmann::ordered_json;
  Json report = Json::parse(report_json, nullptr, /*allow_exceptions=*/false);
  if (!report.is_object()) return Error{ErrorCode::kCorruptData, "the report is not a JSON object"};
  if (!groundtruth.empty()) {
    const auto error = trajectory_error(estimate, groundtruth);
    if (error.ok()) {
      report["groundtruth_matched_frames"] = error->matched_count;
      report["ate_rmse_m"] = error->ate_m.rmse;
      report["ate_max_m"] = error->ate_m.max;
      report["rpe_translation_rmse_m"] = error->per_frame.translation_m.rmse;
      report["rpe_rotation_rmse_deg"] = error->per_frame.rotation_deg.rmse;
    } else {
      report["groundtruth_problem"] = error.error().message;
    }
  }
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace hermite::evaluate
