// The settings of `hermite serve`: one table of names, units, limits and descriptions, which flags
// (--max-scans 4), environment variables (HERMITE_SERVE_MAX_SCANS=4) and the file (max-scans = 4)
// all use. Defaults are those of ServiceOptions.
//
// The file is a subset of TOML: one `key = value` per line, where a value is a "string", an
// integer, true, false, or an array of strings on one line; # starts a comment. Every error names
// the setting, the value and what is allowed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/service/service.h"

namespace hermite::server {

inline constexpr std::size_t kMaxConfigBytes = 64 * 1024;
inline constexpr int kMaxListEntries = 64;

enum class SettingKind { kText, kNumber, kFlag, kList };

struct ServiceSetting {
  std::string key;  // "max-scans"
  SettingKind kind = SettingKind::kText;
  // In the syntax of the file: "\"127.0.0.1:8080\"", "4", "true", "[\"a\", \"b\"]".
  std::string value;
  std::string limits;       // "1 to 64 scans", "auto, json or text"; empty for free text
  std::string environment;  // "HERMITE_SERVE_MAX_SCANS"
  std::string description;  // one line
};
std::vector<ServiceSetting> list_settings(const ServiceOptions& options);

// Sets a setting. A list takes any number of values, everything else exactly one. kInvalidArgument;
// kNotFound: no such setting.
Status apply_setting(ServiceOptions& options, const std::string& key,
                     const std::vector<std::string>& values);

// Applies the text of a file. kInvalidArgument with the line number.
Status apply_config(ServiceOptions& options, const std::string& text);

// Applies environment variables; `variables` as in environ(7). Lists are separated by commas. A
// variable that starts with HERMITE_SERVE_ but is not a setting is an error, since it must be
// misspelt; HERMITE_SERVE_CONFIG is ignored.
Status apply_environment(ServiceOptions& options, const char* const* variables);

// Returns a file that apply_config() can read, with a description above each setting.
std::string format_config(const ServiceOptions& options, const ServiceOptions& defaults);

// Checks the limits of all settings, and the conditions between them.
Status check(const ServiceOptions& options);

}  // namespace hermite::server
