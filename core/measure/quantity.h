// What can be measured in a result, and a value with its interval: declared here and nowhere else. Pure functions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hermite {

enum class MeasureKind : std::uint8_t { kDistance, kPlane, kHeight, kAngle, kArea };

struct MeasureKindRow {
  MeasureKind kind;
  std::string_view name;  // in requests, in the database and on the command line
  std::string_view unit;  // of its value and interval, in JSON and CSV
  std::size_t least_points, most_points;
};

// The corners of an area: as many as somebody clicks on, and their pairs are gone through.
inline constexpr std::size_t kMostCorners = 64;

inline constexpr std::array<MeasureKindRow, 5> kMeasureKinds{{
    {MeasureKind::kDistance, "distance", "m", 2, 2},      // of two points
    {MeasureKind::kPlane, "plane", "m", 2, 2},            // of a point and the plane through the surface at another one
    {MeasureKind::kHeight, "height", "m", 2, 2},          // of two points along the direction that is up
    {MeasureKind::kAngle, "angle", "deg", 2, 2},          // that the surfaces at two points enclose
    {MeasureKind::kArea, "area", "m2", 3, kMostCorners},  // of a polygon in the plane that fits its corners best
}};

const MeasureKindRow& row_of(MeasureKind kind);
std::optional<MeasureKind> measure_kind_of(std::string_view name);  // none: no such kind
std::string measure_kind_names();                                   // "distance, plane, ...", for messages

// How often an interval has the true value, and how many standard deviations to either side that is of a Gaussian error.
inline constexpr double kConfidence = 0.95, kDeviationsOfConfidence = 1.96;
// The same of the length of a two-dimensional one.
inline constexpr double kDeviationsOfConfidenceIn2d = 2.448;

// In the unit of its kind.
struct Quantity {
  MeasureKind kind = MeasureKind::kDistance;
  double value = 0;
  double half_width = 0;                     // of the interval that has the true value with kConfidence
  double surface_sigma = 0, pose_sigma = 0;  // standard deviations that it is made of
  double way_m = 0;                          // CameraWay::between_m, of an area the longest between two corners
};

// "1.234 m ± 0.003 m (95 %)", "89.95° ± 0.21° (95 %)", "1.234 m² ± 0.003 m² (95 %)": the half-width rounded up.
std::string words_of(const Quantity& quantity);

}  // namespace hermite
