// What the poses from which places were seen add to the error of what is measured between them. Pure function.
//
// Poses bring two kinds of error. What every frame has too small the map has too small: some share of every length. And what the camera
// has drifted on its way from one place to another moves them against each other, in every direction alike, by a variance that grows
// with the way. Of what is measured only its derivatives by the places count: by their sums over pairs of places, as in a variogram,
// since moving all places together changes nothing. The factors were measured (tests/accuracy/README.md, "Measuring").
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "core/base/result.h"
#include "core/measure/camera_way.h"
#include "core/measure/surface_fit.h"

namespace hermite {

// What is known of a result beside its surfels.
struct MapKnowledge {
  CameraWay way;
  std::int64_t part_count = 1;        // of the map, whose places relative to each other nobody knows
  bool camera_was_corrected = false;  // it is then known as well as camera_watch.h says
};

struct PoseError {
  double sigma = 0;  // standard deviation of what is measured, by drift alone, in its unit
  double way_m = 0;  // the longest between two of the places
};

// `gradients`: derivatives of what is measured by each place, whose sum is nothing. kInvalidArgument, in words: places lie in different
// parts of the map; no camera of the path can have seen one of them.
Result<PoseError> pose_error_of(std::span<const MeasuredPlace> places, std::span<const Eigen::Vector3d> gradients, const MapKnowledge& map);

// Standard deviation of all lengths, as a share of each.
double length_share_of(const MapKnowledge& map);

}  // namespace hermite
