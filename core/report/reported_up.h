// Which way is up, as report.json says it under "up": in_world, a unit vector, and sigma_deg.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "core/math/up_direction.h"

namespace hermite::report {

void report_up(const UpDirection& up, nlohmann::ordered_json& report);

// Returns nullopt if the report does not say it, or not so.
std::optional<UpDirection> up_in_report(const std::string& report_json);

}  // namespace hermite::report
