#include "core/measure/distance.h"

#include <array>
#include <cmath>

namespace hermite::measure {

namespace {

// Returns the length along `direction`, a unit vector with this standard deviation.
Result<Quantity> length_along(const MeasuredPlace& from, const MeasuredPlace& to,
                              const Eigen::Vector3d& direction, double direction_sigma_rad,
                              const MapKnowledge& map) {
  const Eigen::Vector3d between_m = to.position_m - from.position_m;
  const double apart_m = between_m.norm();
  if (!(apart_m >= kLeastDistance_m))
    return Error{ErrorCode::kInvalidArgument,
                 "the two points are the same place: they are less than 5 mm apart"};
  const std::array places{from, to};
  const std::array<Eigen::Vector3d, 2> gradients{-direction, direction};
  const Result<PoseError> drift = pose_error_of(places, gradients, map);
  if (!drift.ok()) return drift.error();
  Quantity found;
  found.value = std::abs(between_m.dot(direction));
  found.surface_sigma = std::hypot(from.normal_sigma_m * direction.dot(from.normal),
                                   to.normal_sigma_m * direction.dot(to.normal));
  const double across_m = between_m.cross(direction).norm();
  found.pose_sigma =
      std::hypot(drift->sigma, length_share_of(map) * apart_m, direction_sigma_rad * across_m);
  found.way_m = drift->way_m;
  found.half_width = kDeviationsOfConfidence * std::hypot(found.surface_sigma, found.pose_sigma);
  return found;
}

}  // namespace

Result<Quantity> distance_between(const MeasuredPlace& from, const MeasuredPlace& to,
                                  const MapKnowledge& map) {
  const Eigen::Vector3d between_m = to.position_m - from.position_m;
  return length_along(from, to, between_m.normalized(), 0, map);
}

Result<Quantity> height_between(const MeasuredPlace& from, const MeasuredPlace& to,
                                const Eigen::Vector3d& up, const MapKnowledge& map) {
  Result<Quantity> found = length_along(from, to, up, kUpSigma_rad, map);
  if (found.ok()) found->kind = MeasureKind::kHeight;
  return found;
}

}  // namespace hermite::measure
