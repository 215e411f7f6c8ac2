// Counts in messages. Header only.
#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <string>

namespace hermite::client {

// Returns "1 job" or "2 jobs" for `one` = "job".
inline std::string plural(std::uint64_t count, const char* one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

}  // namespace hermite::client
