#include "core/output/cloud_check.h"

#include <fmt/core.h>

#include <cmath>
#include <string>

namespace hermite::output {

Status check_cloud_with_points(const Cloud& cloud) {
  if (cloud.empty()) return Error{ErrorCode::kInvalidArgument, "cloud: it has no points"};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const CloudPoint& point = cloud[i];
    const bool is_finite =
        point.position_m.allFinite() && point.normal.allFinite() &&
        std::isfinite(point.confidence) && std::isfinite(point.curvature_max_per_m) &&
        std::isfinite(point.curvature_min_per_m) && std::isfinite(point.radius_m);
    if (!is_finite)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("cloud: a value of point {} of {} is not finite", i, cloud.size())};
  }
  return Done{};
}

}  // namespace hermite::output
