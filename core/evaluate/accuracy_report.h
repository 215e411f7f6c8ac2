// The accuracy part of report.json, both for local runs and for runs on a server. Pure function.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/dataset/trajectory.h"

namespace hermite::evaluate {

// Returns `report_json`, one object, with these keys added at its end: groundtruth_matched_frames,
// ate_rmse_m, ate_max_m, rpe_translation_rmse_m, rpe_rotation_rmse_deg, or only groundtruth_problem
// as text when the two cannot be compared. Nothing is added without a ground truth. Other keys keep
// their place and value. Indented by 2, with a line feed at the end. kCorruptData when it is not
// one JSON object in UTF-8.
Result<std::string> add_accuracy(const std::string& report_json,
                                 const dataset::Trajectory& estimate,
                                 const dataset::Trajectory& groundtruth);

}  // namespace hermite::evaluate
