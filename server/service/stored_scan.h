// The files of a scan that has ended, for those who look at it.
#pragma once

#include <string>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/service/audience.h"

namespace hermite {

// kNotFound, kIo.
Result<std::string> read_stored_file(const std::string& path);

// What the report says about the map; 0 where there is none.
void read_map_counts(const std::string& folder, wire::ScanState& state);

// What is there is shown: a scan that failed has no files, and that is no error of the viewer.
void show_files(const std::string& folder, Audience& audience);

}  // namespace hermite
