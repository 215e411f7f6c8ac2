// The contribution of the poses, from which places were seen, to the error of a measurement between
// the places. Pure function.
//
// Poses cause two kinds of error. A scale error of all frames is a scale error of the map, a share
// of every length. And the drift of the camera on its path from one place to another moves them
// relative to each other, equally in all directions, with a variance that grows with the length of
// the path. The measurement matters only by its derivatives with respect to the places, in sums
// over pairs of places as in a variogram, because moving all places together changes nothing. The
// factors were measured (tests/accuracy/README.md, "Measuring"); where the scan itself expects a
// larger error of its path than those scans had, its drift is taken to be larger in the same ratio.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "core/base/result.h"
#include "core/measure/camera_way.h"
#include "core/measure/surface_fit.h"

namespace hermite::measure {

// What is known about a result besides its surfels.
struct MapKnowledge {
  CameraWay way;
  std::int64_t part_count = 1;        // components of the map, whose relative poses are unknown
  bool camera_was_corrected = false;  // its accuracy is then that of camera_watch.h
  // ExpectedError::path_m of the frames with depth of their own; 0: not known.
  double expected_path_m = 0;
};

struct PoseError {
  double sigma = 0;  // standard deviation of the measurement by drift alone, in its unit
  double way_m = 0;  // the longest path between two of the places
};

// `gradients` are the derivatives of the measurement by each place, whose sum is zero.
// kInvalidArgument when the map has several components and the places are not in one submap, and
// when no camera of the path can have seen one of them.
Result<PoseError> pose_error_of(std::span<const MeasuredPlace> places,
                                std::span<const Eigen::Vector3d> gradients,
                                const MapKnowledge& map);

// Returns the standard deviation of all lengths as a share of each.
double length_share_of(const MapKnowledge& map);

}  // namespace hermite::measure
