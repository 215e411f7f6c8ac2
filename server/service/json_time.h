// Times as JSON texts. Header only.
#pragma once

#include <cstdint>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string>

namespace hermite {

// "2024-05-01T12:00:00.123Z", null for 0.
inline nlohmann::ordered_json time_json(std::int64_t unix_ms) {
  if (unix_ms == 0) return nullptr;
  const std::time_t seconds = static_cast<std::time_t>(unix_ms / 1000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32], millis[8];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(millis, sizeof millis, ".%03dZ", static_cast<int>(unix_ms % 1000));
  return std::string(text) + millis;
}

}  // namespace hermite
