// The clock of a camera that counts ticks in 32 bits, and starts again when it is full or the camera was reset. A single-threaded value.
#pragma once

#include <cstdint>
#include <optional>

namespace hermite {

class DeviceClock {
 public:
  explicit DeviceClock(double ticks_per_s) : ticks_per_s_(ticks_per_s) {}

  // Seconds since the first stamp. `host_s` is any clock of this machine at the stamp's arrival: where the camera's own has jumped, the
  // time that went by here takes its place. May step back a little, as the stamps of two streams do.
  double seconds_of(std::uint32_t ticks, double host_s);

  static constexpr double kLongestStep_s = 5;        // no camera is silent for so long and then goes on
  static constexpr double kLongestStepBack_s = 0.2;  // some images: colour and depth do not arrive in the order of their stamps

 private:
  const double ticks_per_s_;
  std::optional<std::uint32_t> last_ticks_;
  double last_s_ = 0, last_host_s_ = 0;
};

}  // namespace hermite
