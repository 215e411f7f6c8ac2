// A distance that somebody has measured in a scan and kept, as a row of the store. Plain values.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace hermite {

// Of one scan: more than a person reads through, and a few kilobytes.
inline constexpr int kMaxMeasurementsPerScan = 200;

struct MeasurementRow {
  std::string id;
  std::string scan_id;
  std::string name;                    // for people
  std::array<double, 3> from{}, to{};  // places on the surface, in the world of the scan [m]
  double distance_m = 0;
  double half_width_m = 0;         // of its interval of 95 %
  std::int64_t created_at_ms = 0;  // Unix time
};

}  // namespace hermite
