// The kinds of measurements, and a value with its interval. Everything else takes the kinds from
// here. Pure functions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hermite::measure {

enum class MeasureKind : std::uint8_t { kDistance, kPlane, kHeight, kAngle, kArea };

struct MeasureKindRow {
  MeasureKind kind;
  std::string_view name;  // in requests, in the database and on the command line
  std::string_view unit;  // of its value and interval, in JSON and CSV
  std::size_t least_points, most_points;
};

// Most corners of an area: more than a user would click, and few enough that all pairs can be
// compared.
inline constexpr std::size_t kMostCorners = 64;

inline constexpr std::array<MeasureKindRow, 5> kMeasureKinds{{
    {MeasureKind::kDistance, "distance", "m", 2, 2},  // of two points
    // Distance between a point and the plane through the surface at another point.
    {MeasureKind::kPlane, "plane", "m", 2, 2},
    // Height between two points, along the up direction.
    {MeasureKind::kHeight, "height", "m", 2, 2},
    {MeasureKind::kAngle, "angle", "deg", 2, 2},  // between the surfaces at two points
    // Area of a polygon in the plane that fits its corners best.
    {MeasureKind::kArea, "area", "m2", 3, kMostCorners},
}};

const MeasureKindRow& row_of(MeasureKind kind);
std::optional<MeasureKind> measure_kind_of(std::string_view name);  // nullopt: no such kind
// "distance, plane, ...", for messages.
std::string measure_kind_names();

// The probability that an interval contains the true value, and the corresponding number of
// standard deviations of a Gaussian error to either side.
inline constexpr double kConfidence = 0.95, kDeviationsOfConfidence = 1.96;
// The same for the length of a two-dimensional error.
inline constexpr double kDeviationsOfConfidenceIn2d = 2.448;

// Numbers are in the unit of the kind.
struct Quantity {
  MeasureKind kind = MeasureKind::kDistance;
  double value = 0;
  // Half the width of the interval that contains the true value with probability kConfidence.
  double half_width = 0;
  double surface_sigma = 0, pose_sigma = 0;  // standard deviations of which it consists
  // CameraWay::between_m; for an area, the longest between two corners.
  double way_m = 0;
};

// Returns a text such as "1.234 m ± 0.003 m (95 %)", "89.95° ± 0.21° (95 %)" or "1.234 m² ± 0.003
// m² (95 %)", with the half-width rounded up.
std::string text_of(const Quantity& quantity);

}  // namespace hermite::measure
