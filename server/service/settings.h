// The settings of `hermite serve`: one table of names, units, limits and words. Flags (--max-scans 4), the environment
// (HERMITE_SERVE_MAX_SCANS=4) and the file (max-scans = 4) all go through it. Defaults are ServiceOptions'.
//
// The file is a part of TOML: one `key = value` a line, where a value is a "string", a whole number, true, false, or on one line an array
// of strings; # begins a comment. Every failure names the setting, the value and what is allowed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/service/service.h"

namespace hermite {

inline constexpr std::size_t kMaxConfigBytes = 64 * 1024;
inline constexpr int kMaxListEntries = 64;

enum class SettingKind { kText, kNumber, kFlag, kList };

struct ServiceSetting {
  std::string key;  // "max-scans"
  SettingKind kind = SettingKind::kText;
  std::string value;        // as the file has it: "\"127.0.0.1:8080\"", "4", "true", "[\"a\", \"b\"]"
  std::string limits;       // "1 to 64 scans", "auto, json or text"; empty for free text
  std::string environment;  // "HERMITE_SERVE_MAX_SCANS"
  std::string description;  // one line
};
std::vector<ServiceSetting> list_settings(const ServiceOptions& options);

// A list takes any number of values, everything else exactly one. kInvalidArgument; kNotFound: no such setting.
Status apply_setting(ServiceOptions& options, const std::string& key, const std::vector<std::string>& values);

// kInvalidArgument with the number of the line.
Status apply_config(ServiceOptions& options, const std::string& text);

// `variables` as in environ(7). A list is separated by commas. A variable that begins with HERMITE_SERVE_ and is no setting is an error: it
// is misspelt. HERMITE_SERVE_CONFIG is left alone.
Status apply_environment(ServiceOptions& options, const char* const* variables);

// A file that apply_config() reads back, with what is known of each setting above it.
std::string format_config(const ServiceOptions& options, const ServiceOptions& defaults);

// The limits of all settings and what has to hold between them.
Status check(const ServiceOptions& options);

}  // namespace hermite
