// The file of settings of `hermite serve`, in TOML: one `key = value` for each setting, without
// tables. A value is a string, an integer, true, false, or an array of strings.
#pragma once

#include <cstddef>
#include <string>

#include "core/base/result.h"
#include "server/service/settings_table.h"

namespace hermite::server {

inline constexpr std::size_t kMaxConfigBytes = 64 * 1024;

// Applies the text of a file. kInvalidArgument, with the number of the line.
Status apply_config(ServiceOptions& options, const std::string& text);

// Returns a file that apply_config() can read, with a description above each setting.
std::string format_config(const ServiceOptions& options, const ServiceOptions& defaults);

// Returns the value of a setting as it stands in the file.
std::string toml_of(const SettingRow& row, const ServiceOptions& options);

}  // namespace hermite::server
