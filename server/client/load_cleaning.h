// Removes the scans that a load test has made, as far as its token may.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/client/load_statistics.h"
#include "server/client/scans.h"

namespace hermite::client {

inline constexpr const char* kLoadTag = "load test";

// Deletes the scans, which needs the scope admin; those that still run are stopped first. What is
// left, because of `keep`, of the token or of an error, gets the tag kLoadTag. Blocks; begins
// nothing more after two minutes, or when `give_up` says so.
LoadCleaning clear_load_scans(const ApiTarget& target, const std::vector<std::string>& scan_ids,
                              bool keep, const std::function<bool()>& give_up);

}  // namespace hermite::client
