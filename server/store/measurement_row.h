// A measurement in a scan that a user has saved, as a row of the store. Plain values.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hermite::server {

// Limit per scan: more than a person would read, and only a few kilobytes.
inline constexpr int kMaxMeasurementsPerScan = 200;

struct MeasurementRow {
  using Triple = std::array<double, 3>;

  std::string id;
  std::string scan_id;
  std::string name;  // display name
  // One of the names in core/measure/quantity.h, which also has its unit.
  std::string kind;
  std::vector<Triple> points;  // positions on the surface, in the world frame of the scan [m]
  // Unit normals of the surface at each point; empty: saved by an earlier version, which had none.
  std::vector<Triple> normals;
  std::optional<Triple> up;  // of a height: the up direction, a unit vector
  double value = 0;
  double half_width = 0;           // of the interval around the value, in the same unit
  std::int64_t created_at_ms = 0;  // Unix time
};

}  // namespace hermite::server
