// A tape measure on a finished result: from the files of it to a quantity and its interval. Pure, but for what `points` reads; any thread.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/measure/pose_error.h"
#include "core/measure/quantity.h"
#include "core/output/cloud.h"

namespace hermite {

// Calls use(point) for all points of a result, each time in the same order.
using EachPoint = std::function<Status(const std::function<void(const CloudPoint&)>& use)>;

// What measuring needs of a result.
struct MeasuredResult {
  EachPoint each_point;  // of surfels.ply
  MapKnowledge map;
};

// From the texts of trajectory.txt and report.json. kCorruptData, in words: one of them is not what it should be.
Result<MapKnowledge> map_knowledge_of(const std::string& trajectory_text, const std::string& report_json);

struct MeasureRequest {
  MeasureKind kind = MeasureKind::kDistance;
  std::vector<Eigen::Vector3d> points;  // near to surfaces, in the world of the scan: as many as the kind says (quantity.h)
  std::optional<Eigen::Vector3d> up;    // of a height and nothing else: about a unit vector
};

struct Measurement {
  Quantity quantity;
  std::vector<MeasuredPlace> places;  // on the surface, one for each point; where a plane is meant, on the plane and with its normal
  std::optional<Eigen::Vector3d> up;  // unit
};

// kInvalidArgument, naming the field and the limit: too few or too many points, numbers that are none, a direction up that is missing, of
// another kind or no unit vector. measure() says the same before it reads anything.
Status check_measure_request(const MeasureRequest& request);

// Between the places of the surface that are meant by points near to it. Goes through all points of the result once, where planes are meant
// twice, and keeps those around: up to 50 MB for two planes, some megabytes otherwise. kInvalidArgument, kNotFound, in
// words that name the point, as "points[0]: ...": fit_surface_point, fit_plane, and what the kind is made of. What `each_point` answers.
Result<Measurement> measure(const MeasuredResult& result, const MeasureRequest& request);

// One object: kind, value, half_width, unit, confidence, words, points (the places on the surface), normals, up (of a height),
// surface_sigma and pose_sigma (in the unit), way_m.
std::string format_measurement_json(const Measurement& measurement);

}  // namespace hermite
