// The time of day as the store keeps it. Header only.
#pragma once

#include <chrono>
#include <cstdint>

namespace hermite {

inline std::int64_t unix_now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace hermite
