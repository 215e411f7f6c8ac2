#include "core/measure/measure.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/printf_text.h"
#include "core/measure/area.h"
#include "core/measure/distance.h"
#include "core/measure/plane_measures.h"

namespace hermite::measure {

namespace {

using Json = nlohmann::ordered_json;

// Most points kept. There are some hundreds around a point, and a hundred thousand in a plane; of a
// cloud denser than any scan the first ones of the file are taken.
constexpr std::size_t kMostAround = 100'000, kMostInPlane = 500'000;
// Tolerance for the length of a direction.
constexpr double kUnitSlack = 0.01;

std::string point_name(std::size_t index) { return fmt::format("points[{}]", index); }

bool needs_plane(MeasureKind kind, std::size_t index) {
  return kind == MeasureKind::kAngle || (kind == MeasureKind::kPlane && index == 1);
}

Result<std::vector<MeasuredPlace>> places_of(const EachPoint& each_point,
                                             const std::vector<Eigen::Vector3d>& picks) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& pick : picks) box.extend(pick);
  const Eigen::Vector3d reach_m = Eigen::Vector3d::Constant(kFitReach_m);
  box = Eigen::AlignedBox3d(box.min() - reach_m, box.max() + reach_m);
  std::vector<std::vector<output::CloudPoint>> around(picks.size());
  const Status read = each_point([&](const output::CloudPoint& point) {
    if (!box.contains(point.position_m.cast<double>())) return;
    for (std::size_t i = 0; i < picks.size(); ++i)
      if ((point.position_m.cast<double>() - picks[i]).squaredNorm() <= kFitReach_m * kFitReach_m &&
          around[i].size() < kMostAround)
        around[i].push_back(point);
  });
  if (!read.ok()) return read.error();
  std::vector<MeasuredPlace> places;
  for (std::size_t i = 0; i < picks.size(); ++i) {
    const Result<MeasuredPlace> place = fit_surface_point(around[i], picks[i]);
    if (!place.ok()) return in_context(point_name(i), place.error());
    places.push_back(*place);
  }
  return places;
}

// Fits planes at those places where the kind needs one; the others are empty.
Result<std::vector<MeasuredPlane>> planes_of(const MeasuredResult& result, MeasureKind kind,
                                             const std::vector<MeasuredPlace>& places) {
  std::vector<std::vector<output::CloudPoint>> candidates(places.size());
  const Status read = result.each_point([&](const output::CloudPoint& point) {
    for (std::size_t i = 0; i < places.size(); ++i)
      if (needs_plane(kind, i) && candidates[i].size() < kMostInPlane &&
          may_be_of_plane(point, places[i]))
        candidates[i].push_back(point);
  });
  if (!read.ok()) return read.error();
  std::vector<MeasuredPlane> planes(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!needs_plane(kind, i)) continue;
    const Result<MeasuredPlane> plane =
        fit_plane(candidates[i], places[i], result.map.part_count > 1);
    if (!plane.ok()) return in_context(point_name(i), plane.error());
    planes[i] = *plane;
  }
  return planes;
}

Json json_triple(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Result<Quantity> quantity_of(const Measurement& measurement,
                             const std::vector<MeasuredPlane>& planes, const MapKnowledge& map) {
  const std::vector<MeasuredPlace>& places = measurement.places;
  switch (measurement.quantity.kind) {
    case MeasureKind::kDistance: return distance_between(places[0], places[1], map);
    case MeasureKind::kPlane: return distance_to_plane(places[0], planes[1], map);
    case MeasureKind::kHeight: return height_between(places[0], places[1], *measurement.up, map);
    case MeasureKind::kAngle: return angle_between(planes[0], planes[1], map);
    case MeasureKind::kArea: return area_of(places, map);
  }
  return Error{ErrorCode::kInvalidArgument, "kind is none of " + measure_kind_names()};
}

constexpr double kMostLength_m = 1e4;

// Returns a length that is stated, and 0 if there is none or none that a scan can have.
double length_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  const double length_m = found != object.end() && found->is_number() ? found->get<double>() : 0;
  return length_m >= 0 && length_m < kMostLength_m ? length_m : 0;
}

}  // namespace

Result<MapKnowledge> map_knowledge_of(const std::string& trajectory_text,
                                      const std::string& report_json) {
  Result<dataset::Trajectory> trajectory = dataset::parse_tum_trajectory(trajectory_text);
  if (!trajectory.ok())
    return in_context("trajectory.txt", Error{ErrorCode::kCorruptData, trajectory.error().message});
  const Json report = Json::parse(report_json, nullptr, false);
  if (!report.is_object()) return Error{ErrorCode::kCorruptData, "report.json is no JSON object"};
  MapKnowledge map{CameraWay(*trajectory), 1, report.contains("corrected_camera")};
  if (const auto mapping = report.find("mapping");
      mapping != report.end() && mapping->is_object()) {
    const auto parts = mapping->find("parts");
    if (parts != mapping->end() && parts->is_number_integer())
      map.part_count = parts->get<std::int64_t>();
  }
  if (const auto expected = report.find("expected_error");
      expected != report.end() && expected->is_object()) {
    const double path_m = length_in(*expected, "path_m"), stall_m = length_in(*expected, "stall_m");
    map.expected_path_m = std::sqrt(std::max(0.0, path_m * path_m - stall_m * stall_m));
  }
  return map;
}

Status check_measure_request(const MeasureRequest& request) {
  const MeasureKindRow& row = row_of(request.kind);
  const std::size_t count = request.points.size();
  if (count < row.least_points || count > row.most_points) {
    const std::string allowed =
        std::to_string(row.least_points) +
        (row.most_points == row.least_points ? "" : " to " + std::to_string(row.most_points));
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("points has {} points, of kind {} are allowed {}", count, row.name, allowed)};
  }
  for (std::size_t i = 0; i < count; ++i)
    if (!request.points[i].allFinite())
      return Error{ErrorCode::kInvalidArgument, point_name(i) + " is not three finite numbers"};
  if (request.up.has_value() != (request.kind == MeasureKind::kHeight))
    return Error{ErrorCode::kInvalidArgument,
                 request.up ? "up belongs to kind height alone"
                            : "up is missing: of kind height it says which way is up, [x, y, z]"};
  if (!request.up) return Done{};
  const double length = request.up->norm();
  if (!(std::abs(length - 1) <= kUnitSlack))
    return Error{
        ErrorCode::kInvalidArgument,
        printf_text("up must be a unit vector: its length is %.3g, allowed are %.2f to %.2f",
                    length, 1 - kUnitSlack, 1 + kUnitSlack)};
  return Done{};
}

Result<Measurement> measure(const MeasuredResult& result, const MeasureRequest& request) {
  if (const Status status = check_measure_request(request); !status.ok()) return status.error();
  Result<std::vector<MeasuredPlace>> places = places_of(result.each_point, request.points);
  if (!places.ok()) return places.error();
  Measurement measurement;
  measurement.quantity.kind = request.kind;
  measurement.places = *std::move(places);
  if (request.up) measurement.up = request.up->normalized();
  std::vector<MeasuredPlane> planes;
  if (request.kind == MeasureKind::kPlane || request.kind == MeasureKind::kAngle) {
    Result<std::vector<MeasuredPlane>> found = planes_of(result, request.kind, measurement.places);
    if (!found.ok()) return found.error();
    planes = *std::move(found);
    for (std::size_t i = 0; i < planes.size(); ++i)
      if (needs_plane(request.kind, i)) measurement.places[i] = planes[i].place;
  }
  const Result<Quantity> quantity = quantity_of(measurement, planes, result.map);
  if (!quantity.ok()) return quantity.error();
  measurement.quantity = *quantity;
  return measurement;
}

std::string format_measurement_json(const Measurement& measurement) {
  const Quantity& quantity = measurement.quantity;
  const MeasureKindRow& row = row_of(quantity.kind);
  Json json = {
      {"kind", row.name},        {"value", quantity.value},   {"half_width", quantity.half_width},
      {"unit", row.unit},        {"confidence", kConfidence}, {"words", text_of(quantity)},
      {"points", Json::array()}, {"normals", Json::array()}};
  for (const MeasuredPlace& place : measurement.places) {
    json["points"].push_back(json_triple(place.position_m));
    json["normals"].push_back(json_triple(place.normal));
  }
  if (measurement.up) json["up"] = json_triple(*measurement.up);
  json["surface_sigma"] = quantity.surface_sigma;
  json["pose_sigma"] = quantity.pose_sigma;
  json["way_m"] = quantity.way_m;
  return json.dump();
}

}  // namespace hermite::measure
