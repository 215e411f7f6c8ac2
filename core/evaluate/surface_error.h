// Measures how far the points of a reconstruction are from the true surface. Pure functions.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/math/rigid3.h"

namespace hermite::evaluate {

struct SurfaceError {
  std::int64_t point_count = 0;
  double mean_m = 0, median_m = 0, rmse_m = 0;
  // The smallest distance that at least 95 % of the points do not exceed.
  double percentile95_m = 0;
  double max_m = 0;
};

// `distance_m` returns the unsigned distance [m] of a point of the true world from the true surface
// (SyntheticRoom::surface_distance); `world_from_cloud` is the pose of the cloud in that world,
// usually the alignment of its trajectory. kInvalidArgument for no points, and for a point or a
// distance that is not finite.
Result<SurfaceError> surface_error(const std::vector<Eigen::Vector3d>& points_in_cloud,
                                   const Rigid3& world_from_cloud,
                                   const std::function<double(const Eigen::Vector3d&)>& distance_m);

// The same for known distances [m] in any order.
Result<SurfaceError> surface_error(std::vector<double> distances_m);

// Returns an object with the keys surface_points, surface_{mean,median,rmse,percentile95,max}_m.
std::string format_surface_error_json(const SurfaceError& error);

}  // namespace hermite::evaluate
