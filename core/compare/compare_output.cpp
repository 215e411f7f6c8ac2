#include "core/compare/compare_output.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/output/thin.h"

namespace hermite::compare {

namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little,
              "values are written in the byte order of the CPU");

constexpr double kFullColor_m = 0.05;
constexpr std::int32_t kNoRegion = -1;
constexpr Rgb8 kRemoved{214, 39, 196}, kAdded{44, 180, 60};

Json list_of(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

template <class Matrix>
Json rows_of(const Matrix& matrix) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    Json values = Json::array();
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      values.push_back(matrix(row, column));
    rows.push_back(std::move(values));
  }
  return rows;
}

Json registration_json(const Registration& registration) {
  const CoarseAgreement& agreement = registration.agreement;
  Json json{{"verdict", name_of(registration.verdict)},
            {"words", registration.message},
            {"agreeing_share", agreement.share()},
            {"overlap", agreement.overlap()}};
  if (agreement.has_color) json["color_difference"] = agreement.color_difference;
  if (registration.verdict == RegistrationVerdict::kDifferentPlaces ||
      registration.verdict == RegistrationVerdict::kMirrored)
    return json;
  const ScanAlignment& alignment = registration.alignment;
  json["a_from_b"] = rows_of(alignment.a_from_b.matrix());
  json["covariance"] = rows_of(alignment.covariance);
  json["weakest_sigma_m"] = alignment.weakest_sigma_m;
  json["disagreement_m"] = alignment.disagreement_m;
  return json;
}

Json region_json(const ChangedRegion& region) {
  Json json{
      {"kind", name_of(region.kind)}, {"area_m2", region.area_m2}, {"places", region.place_count}};
  if (region.kind == RegionKind::kMovedAway || region.kind == RegionKind::kMovedTowards) {
    json["mean_distance_m"] = region.mean_distance_m;
    json["sigma_m"] = region.sigma_m;
    json["farthest_m"] = region.farthest_m;
  }
  json["low_m"] = list_of(region.low_m);
  json["high_m"] = list_of(region.high_m);
  return json;
}

std::vector<std::int32_t> regions_by_place(const Comparison& comparison, bool of_a) {
  const ComparedSurface& surface = of_a ? comparison.surface_a : comparison.surface_b;
  std::vector<std::int32_t> regions(surface.places.size(), kNoRegion);
  const std::size_t first = of_a ? 0 : comparison.regions_of_a,
                    last = of_a ? comparison.regions_of_a : comparison.regions.size();
  for (std::size_t region = first; region < last; ++region)
    for (const std::uint32_t place : comparison.regions[region].places)
      regions[place] = static_cast<std::int32_t>(region);
  return regions;
}

Rgb8 color_of(const ComparedPlace& place, std::int32_t region, bool of_a, const Rgb8& own) {
  if (region != kNoRegion && place.state == PlaceState::kGone) return of_a ? kRemoved : kAdded;
  if (region == kNoRegion || !place.distance_m) {
    const int grey = (own.r + own.g + own.b) / 3,
              dimmed = place.state == PlaceState::kUnseen ? grey / 3 : 60 + grey / 2;
    const auto value = static_cast<std::uint8_t>(std::min(dimmed, 255));
    return {value, value, value};
  }
  const double share = std::clamp(std::abs(*place.distance_m) / kFullColor_m, 0.0, 1.0);
  const auto faded = static_cast<std::uint8_t>(std::lround(200 * (1 - share)));
  return *place.distance_m > 0 ? Rgb8{230, faded, faded} : Rgb8{faded, faded, 230};
}

template <class... Values>
void append(std::string& bytes, const Values&... values) {
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
}

// Of a surfel and its place, in the order of append_place().
const std::string kPlaceProperties =
    "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float "
    "ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float "
    "distance\nproperty float sigma\n";

void append_place(std::string& bytes, const output::CloudPoint& point, const Rgb8& color,
                  const ComparedPlace& place) {
  const auto distance_m =
      static_cast<float>(place.distance_m.value_or(std::numeric_limits<double>::quiet_NaN()));
  append(bytes, point.position_m.x(), point.position_m.y(), point.position_m.z(), point.normal.x(),
         point.normal.y(), point.normal.z(), color.r, color.g, color.b, distance_m,
         static_cast<float>(place.sigma_m));
}

// Returns the number of points.
std::size_t append_points(const Comparison& comparison, bool of_a, std::string& bytes) {
  const ComparedSurface& surface = of_a ? comparison.surface_a : comparison.surface_b;
  const output::Cloud& surfels = of_a ? comparison.surfels_a : comparison.surfels_b;
  const std::vector<std::int32_t> regions = regions_by_place(comparison, of_a);
  std::size_t count = 0;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const std::uint32_t index = surface.of_surfel[i];
    const ComparedPlace& place = surface.places[index];
    if (!of_a && regions[index] == kNoRegion) continue;
    append_place(bytes, surfels[i], color_of(place, regions[index], of_a, surfels[i].color), place);
    append(bytes, regions[index]);
    ++count;
  }
  return count;
}

PointState state_of(const ComparedPlace& place, std::int32_t region, bool of_a) {
  if (place.state == PlaceState::kUnseen) return PointState::kUnseen;
  if (region == kNoRegion)
    return place.state == PlaceState::kGone ? PointState::kUnseen : PointState::kSame;
  if (place.state != PlaceState::kGone) return PointState::kMoved;
  return of_a ? PointState::kRemoved : PointState::kAdded;
}

// The surfels of a scan that are shown: at most kMostShownPoints, in their order.
std::vector<std::uint32_t> shown_surfels(const output::Cloud& surfels) {
  output::Cloud numbered = surfels;
  // Thinning keeps the points whole.
  for (std::size_t i = 0; i < numbered.size(); ++i)
    numbered[i].submap = static_cast<std::uint32_t>(i);
  std::vector<std::uint32_t> shown;
  for (const output::CloudPoint& point : output::thinned(numbered, kMostShownPoints))
    shown.push_back(point.submap);
  return shown;
}

// The second scan's moved places are none of its own regions: a region that moved lies on the first
// one's surface. They get the state by their distance alone, so that both surfaces look alike.
PointState state_of_second(const ComparedPlace& place, std::int32_t region) {
  const bool has_moved =
      place.is_certain && (place.state == PlaceState::kAway || place.state == PlaceState::kTowards);
  return has_moved ? PointState::kMoved : state_of(place, region, false);
}

// Returns the number of points.
std::size_t append_shown(const Comparison& comparison, bool of_a, std::string& bytes) {
  const ComparedSurface& surface = of_a ? comparison.surface_a : comparison.surface_b;
  const output::Cloud& surfels = of_a ? comparison.surfels_a : comparison.surfels_b;
  const std::vector<std::int32_t> regions = regions_by_place(comparison, of_a);
  const std::vector<std::uint32_t> shown = shown_surfels(surfels);
  for (const std::uint32_t i : shown) {
    const output::CloudPoint& point = surfels[i];
    const std::uint32_t index = surface.of_surfel[i];
    const ComparedPlace& place = surface.places[index];
    const PointState state =
        of_a ? state_of(place, regions[index], true) : state_of_second(place, regions[index]);
    append_place(bytes, point, point.color, place);
    append(bytes, static_cast<std::uint8_t>(state), static_cast<std::uint8_t>(of_a ? 0 : 1),
           regions[index]);
  }
  return shown.size();
}

}  // namespace

std::string format_comparison_json(const Comparison& comparison, const ChangeOptions& options) {
  Json report = registration_json(comparison.registration);
  report["least_change_m"] = options.least_change_m;
  report["least_deviations"] = options.least_deviations;
  report["least_area_m2"] = options.least_area_m2;
  report["parts_of_a"] = comparison.parts_of_a;
  report["parts_of_b"] = comparison.parts_of_b;
  if (comparison.registration.verdict != RegistrationVerdict::kSamePlace)
    return report.dump(2) + "\n";
  report["path_of_a_is_known"] = comparison.sees_a;
  report["path_of_b_is_known"] = comparison.sees_b;
  report["compared_area_m2"] = comparison.compared_area_m2;
  report["unseen_area_m2"] = comparison.unseen_area_m2;
  Json regions = Json::array();
  for (const ChangedRegion& region : comparison.regions) regions.push_back(region_json(region));
  report["regions"] = std::move(regions);
  return report.dump(2) + "\n";
}

std::string format_changes_ply(const Comparison& comparison) {
  std::string points;
  const std::size_t count =
      append_points(comparison, true, points) + append_points(comparison, false, points);
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\n"
             "comment Hermite comparison: metres, normals towards the camera\n"
             "element vertex {}{}property int region\nend_header\n",
             count, kPlaceProperties) +
         points;
}

std::string format_compared_points_ply(const Comparison& comparison) {
  std::string points;
  const std::size_t count =
      append_shown(comparison, true, points) + append_shown(comparison, false, points);
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\n"
             "comment Hermite comparison of two scans: metres, in the first one's world\n"
             "element vertex {}{}property uchar state\nproperty uchar scan\n"
             "property int region\nend_header\n",
             count, kPlaceProperties) +
         points;
}

}  // namespace hermite::compare
