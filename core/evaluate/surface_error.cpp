#include "core/evaluate/surface_error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace hermite::evaluate {

Result<SurfaceError> surface_error(
    const std::vector<Eigen::Vector3d>& points_in_cloud, const Rigid3& world_from_cloud,
    const std::function<double(const Eigen::Vector3d&)>& distance_m) {
  std::vector<double> distances_m;
  distances_m.reserve(points_in_cloud.size());
  for (const Eigen::Vector3d& point : points_in_cloud)
    distances_m.push_back(distance_m(world_from_cloud * point));
  return surface_error(std::move(distances_m));
}

Result<SurfaceError> surface_error(std::vector<double> distances_m) {
  if (distances_m.empty())
    return Error{ErrorCode::kInvalidArgument,
                 "the surface error of a cloud without points is undefined"};
  double sum_m = 0, sum_of_squares_m2 = 0;
  for (std::size_t i = 0; i < distances_m.size(); ++i) {
    if (!std::isfinite(distances_m[i]))
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("point {} has no finite distance to the surface", i)};
    sum_m += distances_m[i];
    sum_of_squares_m2 += distances_m[i] * distances_m[i];
  }
  std::sort(distances_m.begin(), distances_m.end());
  const std::size_t count = distances_m.size(), middle = count / 2;
  const std::size_t rank95 = (count * 95 + 99) / 100;  // rounded up; counts from 1

  SurfaceError error;
  error.point_count = static_cast<std::int64_t>(count);
  error.mean_m = sum_m / static_cast<double>(count);
  error.median_m =
      count % 2 == 1 ? distances_m[middle] : 0.5 * (distances_m[middle - 1] + distances_m[middle]);
  error.rmse_m = std::sqrt(sum_of_squares_m2 / static_cast<double>(count));
  error.percentile95_m = distances_m[rank95 - 1];
  error.max_m = distances_m.back();
  return error;
}

std::string format_surface_error_json(const SurfaceError& error) {
  nlohmann::ordered_json json;
  json["surface_points"] = error.point_count;
  json["surface_mean_m"] = error.mean_m;
  json["surface_median_m"] = error.median_m;
  json["surface_rmse_m"] = error.rmse_m;
  json["surface_percentile95_m"] = error.percentile95_m;
  json["surface_max_m"] = error.max_m;
  return json.dump(2) + "\n";
}

}  // namespace hermite::evaluate
