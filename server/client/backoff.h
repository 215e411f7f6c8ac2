// How long to wait before each attempt to connect again: "full jitter", so that a thousand clients of a server that was restarted do not
// all come back in the same moment. Knows no clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <random>

namespace hermite {

inline constexpr std::chrono::milliseconds kFirstBackoff{500};
inline constexpr std::chrono::milliseconds kLongestBackoff{30'000};

class Backoff {
 public:
  explicit Backoff(std::uint32_t seed) : random_(seed) {}

  // Anything from 0 to a limit that starts at kFirstBackoff and doubles up to kLongestBackoff.
  std::chrono::milliseconds next();

 private:
  std::mt19937 random_;
  std::chrono::milliseconds limit_ = kFirstBackoff;
};

}  // namespace hermite
