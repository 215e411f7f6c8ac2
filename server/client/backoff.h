// How long to wait before each attempt to reconnect: exponential backoff with full jitter, so that
// a thousand clients of a restarted server do not all come back at the same moment. Reads no clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <random>

namespace hermite::client {

inline constexpr std::chrono::milliseconds kFirstBackoff{500};
inline constexpr std::chrono::milliseconds kLongestBackoff{30'000};

class Backoff {
 public:
  explicit Backoff(std::uint32_t seed) : random_(seed) {}

  // Returns a random time from 0 to a limit that starts at kFirstBackoff and doubles up to
  // kLongestBackoff.
  std::chrono::milliseconds next();

 private:
  std::mt19937 random_;
  std::chrono::milliseconds limit_ = kFirstBackoff;
};

}  // namespace hermite::client
