#include "server/capture/device_clock.h"

#include <algorithm>
#include <utility>

namespace hermite::client {

double DeviceClock::seconds_of(std::uint32_t ticks, double host_s) {
  const std::optional<std::uint32_t> before = std::exchange(last_ticks_, ticks);
  const double host_step_s = host_s - std::exchange(last_host_s_, host_s);
  if (!before) return last_s_;
  // The signed difference is correct across the wraparound, in both directions.
  const double step_s =
      static_cast<double>(static_cast<std::int32_t>(ticks - *before)) / ticks_per_s_;
  const bool jumped = step_s > kLongestStep_s || step_s < -kLongestStepBack_s;
  last_s_ += jumped ? std::max(host_step_s, 0.0) : step_s;
  return last_s_;
}

}  // namespace hermite::client
