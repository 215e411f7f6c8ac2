// What somebody has measured in a scan and kept, as a row of the store. Plain values.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hermite {

// Of one scan: more than a person reads through, and a few kilobytes.
inline constexpr int kMaxMeasurementsPerScan = 200;

struct MeasurementRow {
  using Triple = std::array<double, 3>;

  std::string id;
  std::string scan_id;
  std::string name;             // for people
  std::string kind;             // one of the names in core/measure/quantity.h, which also has its unit
  std::vector<Triple> points;   // places on the surface, in the world of the scan [m]
  std::vector<Triple> normals;  // of the surface at each point, unit; empty: kept by an earlier version, which had none
  std::optional<Triple> up;     // of a height: what was up, unit
  double value = 0;
  double half_width = 0;           // of the interval around it, in the same unit
  std::int64_t created_at_ms = 0;  // Unix time
};

}  // namespace hermite
