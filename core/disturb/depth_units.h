// Converts depth to the values that a sensor would store. Header only.
#pragma once

#include <cmath>
#include <cstdint>

namespace hermite::disturb {

// Returns 0, no measurement, for values that 16 bits cannot hold.
inline std::uint16_t to_depth_units(double depth_m, double units_per_metre) {
  const double units = std::round(depth_m * units_per_metre);
  return units >= 1 && units <= 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

}  // namespace hermite::disturb
