#include "core/measure/measure.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace hermite {

namespace {

using Json = nlohmann::ordered_json;

// Around a pick there are some hundreds; of a cloud that lies denser than any scan the first of the file are taken.
constexpr std::size_t kMostAround = 100'000;

struct Around {
  Eigen::Vector3f pick;
  std::vector<CloudPoint> points;

  void add(const CloudPoint& point) {
    if ((point.position_m - pick).squaredNorm() <= static_cast<float>(kFitReach_m * kFitReach_m) && points.size() < kMostAround)
      points.push_back(point);
  }
};

Json json_of(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

}  // namespace

Result<MapKnowledge> map_knowledge_of(const std::string& trajectory_text, const std::string& report_json) {
  Result<Trajectory> trajectory = parse_tum_trajectory(trajectory_text);
  if (!trajectory.ok()) return in_context("trajectory.txt", Error{ErrorCode::kCorruptData, trajectory.error().message});
  const Json report = Json::parse(report_json, nullptr, false);
  if (!report.is_object()) return Error{ErrorCode::kCorruptData, "report.json is no JSON object"};
  MapKnowledge map{CameraWay(*trajectory), 1, report.contains("corrected_camera")};
  if (const auto mapping = report.find("mapping"); mapping != report.end() && mapping->is_object()) {
    const auto parts = mapping->find("parts");
    if (parts != mapping->end() && parts->is_number_integer()) map.part_count = parts->get<std::int64_t>();
  }
  return map;
}

Result<Measurement> measure_distance(const MeasuredResult& result, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  for (const auto& [pick, name] : {std::pair{&from, "from"}, std::pair{&to, "to"}})
    if (!pick->allFinite()) return Error{ErrorCode::kInvalidArgument, std::string(name) + ": not three finite numbers"};
  Around around_from{from.cast<float>(), {}}, around_to{to.cast<float>(), {}};
  const Status read = for_each_ply_point(result.surfels, [&](const CloudPoint& point) {
    around_from.add(point);
    around_to.add(point);
  });
  if (!read.ok()) return read.error();
  const Result<MeasuredPlace> from_fit = fit_surface_point(around_from.points, from), to_fit = fit_surface_point(around_to.points, to);
  if (!from_fit.ok()) return in_context("from", from_fit.error());
  if (!to_fit.ok()) return in_context("to", to_fit.error());
  const Result<Distance> distance = distance_between(*from_fit, *to_fit, result.map);
  if (!distance.ok()) return distance.error();
  return Measurement{*from_fit, *to_fit, *distance};
}

std::string format_measurement_json(const Measurement& measurement) {
  const Distance& distance = measurement.distance;
  const Json json = {{"distance_m", distance.distance_m},
                     {"half_width_m", distance.half_width_m},
                     {"confidence", 0.95},
                     {"words", words_of(distance)},
                     {"from", json_of(measurement.from.position_m)},
                     {"to", json_of(measurement.to.position_m)},
                     {"from_normal", json_of(measurement.from.normal)},
                     {"to_normal", json_of(measurement.to.normal)},
                     {"surface_sigma_m", distance.surface_sigma_m},
                     {"pose_sigma_m", distance.pose_sigma_m},
                     {"way_m", distance.way_m}};
  return json.dump();
}

}  // namespace hermite
