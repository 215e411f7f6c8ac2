// Times in JSON. Header only.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "server/store/unix_time.h"

namespace hermite::server {

// Returns for example "2024-05-01T12:00:00.123Z"; null for 0.
inline nlohmann::ordered_json time_json(std::int64_t unix_ms) {
  if (unix_ms == 0) return nullptr;
  return utc_text(unix_ms);
}

}  // namespace hermite::server
