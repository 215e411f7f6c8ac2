// The clock of a camera with a 32-bit tick counter, which wraps around and may be reset. A
// single-threaded value.
#pragma once

#include <cstdint>
#include <optional>

namespace hermite::client {

class DeviceClock {
 public:
  explicit DeviceClock(double ticks_per_s) : ticks_per_s_(ticks_per_s) {}

  // Returns the seconds since the first timestamp. `host_s` is the time of arrival by any clock of
  // this machine: if the camera's clock jumps, the time that has passed by this clock is used
  // instead. May step back slightly, as the timestamps of two streams do.
  double seconds_of(std::uint32_t ticks, double host_s);

  // No camera pauses for this long and then continues.
  static constexpr double kLongestStep_s = 5;
  // Some images: colour and depth do not arrive in the order of their timestamps.
  static constexpr double kLongestStepBack_s = 0.2;

 private:
  const double ticks_per_s_;
  std::optional<std::uint32_t> last_ticks_;
  double last_s_ = 0, last_host_s_ = 0;
};

}  // namespace hermite::client
