#include "server/capture/kinect_depth.h"

#include <array>
#include <cmath>

namespace hermite::client {
namespace {

constexpr std::size_t kRawValues = 2048;
// Libfreenect's own limit; there the resolution of the sensor is 30 cm.
constexpr double kFarthest_m = 10;

std::array<std::uint16_t, kRawValues> make_table() {
  std::array<std::uint16_t, kRawValues> table{};
  for (std::size_t raw = 0; raw + 1 < kRawValues; ++raw) {
    const double inverse = 3.3309495161 - 0.0030711016 * static_cast<double>(raw);
    if (inverse >= 1 / kFarthest_m)
      table[raw] = static_cast<std::uint16_t>(std::lround(1000 / inverse));
  }
  return table;
}

}  // namespace

std::uint16_t kinect_depth_mm(std::uint16_t raw) {
  static const std::array<std::uint16_t, kRawValues> table = make_table();
  return raw < kRawValues ? table[raw] : 0;
}

}  // namespace hermite::client
