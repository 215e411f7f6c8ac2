// Measures in a finished result: from its files to a quantity with its interval. Pure, except for
// what `points` reads. Any thread.
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

namespace hermite::measure {

// Calls use(point) for all points of a result, in the same order each time.
using EachPoint = std::function<Status(const std::function<void(const output::CloudPoint&)>& use)>;

// The parts of a result that measuring needs.
struct MeasuredResult {
  EachPoint each_point;  // of surfels.ply
  MapKnowledge map;
};

// Reads the texts of trajectory.txt and report.json. kCorruptData when one of them is invalid.
Result<MapKnowledge> map_knowledge_of(const std::string& trajectory_text,
                                      const std::string& report_json);

struct MeasureRequest {
  MeasureKind kind = MeasureKind::kDistance;
  // Near surfaces, in the world of the scan: as many as the kind requires (quantity.h).
  std::vector<Eigen::Vector3d> points;
  std::optional<Eigen::Vector3d> up;  // only for heights: approximately a unit vector
};

struct Measurement {
  Quantity quantity;
  // On the surface, one for each point; where the kind needs a plane, on the plane with its normal.
  std::vector<MeasuredPlace> places;
  std::optional<Eigen::Vector3d> up;  // unit
};

// Returns kInvalidArgument, naming the field and the limit, for too few or too many points, for
// numbers that are not finite, and for an up direction that is missing, of another kind or not a
// unit vector. measure() checks the same before it reads anything.
Status check_measure_request(const MeasureRequest& request);

// Measures between the places of the surface near the given points. Reads all points of the result
// once, or twice if planes are needed, and keeps those nearby: up to 50 MB for two planes, some
// megabytes otherwise. kInvalidArgument and kNotFound, with a message that names the point as in
// "points[0]: ...", as for fit_surface_point, fit_plane and the functions of the kind. Also the
// errors of `each_point`.
Result<Measurement> measure(const MeasuredResult& result, const MeasureRequest& request);

// Returns one object with kind, value, half_width, unit, confidence, words, points (the places on
// the surface), normals, up (of a height), surface_sigma and pose_sigma (in the unit), way_m.
std::string format_measurement_json(const Measurement& measurement);

}  // namespace hermite::measure
