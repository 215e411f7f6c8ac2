// The settings of `hermite serve`: one table of names, units, limits and descriptions, which flags
// (--max-scans 4), environment variables (HERMITE_SERVE_MAX_SCANS=4) and the file (max-scans = 4)
// all use. Defaults are those of ServiceOptions.
// Every error names the setting, the value and what is allowed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/service/service.h"

namespace hermite::server {

inline constexpr int kMaxListEntries = 64;

enum class SettingKind { kText, kNumber, kFlag, kList };

struct ServiceSetting {
  std::string key;  // "max-scans"
  SettingKind kind = SettingKind::kText;
  // As in the file: "\"127.0.0.1:8080\"", "4", "true", "[\"a\", \"b\"]".
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

// Applies environment variables; `variables` as in environ(7). Lists are separated by commas. A
// variable that starts with HERMITE_SERVE_ but is not a setting is an error, since it must be
// misspelt; HERMITE_SERVE_CONFIG is ignored.
Status apply_environment(ServiceOptions& options, const char* const* variables);

// Checks the limits of all settings, and the conditions between them.
Status check(const ServiceOptions& options);

}  // namespace hermite::server
