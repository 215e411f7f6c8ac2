// The accuracy part of report.json, for a run on this machine and for one on a server alike. Pure function.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/dataset/trajectory.h"

namespace hermite {

// `report_json`, one object, with every ate_… and rpe_… key of format_trajectory_error_json added at its end (or replaced); other keys keep
// their place and value. Indented by 2. kCorruptData: not one JSON object. kInvalidArgument: as trajectory_error, few poses that match for
// one.
Result<std::string> add_accuracy(const std::string& report_json, const Trajectory& estimate, const Trajectory& groundtruth);

}  // namespace hermite
