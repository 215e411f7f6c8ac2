// A tape measure on a finished result: from the files of it to a distance and its interval. Pure, but for what `surfels` reads; any thread.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/measure/distance.h"
#include "core/output/ply_points.h"

namespace hermite {

// The files of a result that measuring needs.
struct MeasuredResult {
  ReadPart surfels;  // of surfels.ply
  MapKnowledge map;
};

// From the texts of trajectory.txt and report.json. kCorruptData, in words: one of them is not what it should be.
Result<MapKnowledge> map_knowledge_of(const std::string& trajectory_text, const std::string& report_json);

struct Measurement {
  MeasuredPlace from, to;
  Distance distance;
};

// Between the places of the surface that are meant by two points near to it, in the world of the scan. Reads all surfels once, and keeps
// those around the points. kInvalidArgument, kNotFound, in words that name the point: fit_surface_point, distance_between. What `surfels`
// answers.
Result<Measurement> measure_distance(const MeasuredResult& result, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// One object, metres: distance_m, half_width_m, confidence (0.95), words, from and to (the places on the surface), from_normal, to_normal,
// surface_sigma_m, pose_sigma_m, way_m.
std::string format_measurement_json(const Measurement& measurement);

}  // namespace hermite
