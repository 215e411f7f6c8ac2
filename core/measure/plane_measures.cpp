#include "core/measure/plane_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hermite::measure {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

// Rotation between planes by pose errors: what remains between planes that one camera has seen, and
// what grows with the square root of the path length. Measured.
constexpr double kTurnFloor_rad = 0.0003, kTurnOfWay_rad = 0.0003;

// Returns the standard deviation [rad] of the rotation of a plane's normal about an axis in the
// plane, or of the larger rotation if the axis is not in the plane.
double turn_sigma_of(const MeasuredPlane& plane, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d along = axis.cross(plane.place.normal);
  if (along.norm() < 1e-6) return std::max(plane.slope_sigma[0], plane.slope_sigma[1]);
  return std::hypot(plane.slope_sigma[0] * plane.axes[0].dot(along.normalized()),
                    plane.slope_sigma[1] * plane.axes[1].dot(along.normalized()));
}

}  // namespace

Result<Quantity> distance_to_plane(const MeasuredPlace& from, const MeasuredPlane& plane,
                                   const MapKnowledge& map) {
  const Eigen::Vector3d& normal = plane.place.normal;
  const Eigen::Vector3d between_m = plane.place.position_m - from.position_m;
  const std::array places{from, plane.place};
  const std::array<Eigen::Vector3d, 2> gradients{-normal, normal};
  const Result<PoseError> drift = pose_error_of(places, gradients, map);
  if (!drift.ok()) return drift.error();
  const double off_m = normal.dot(between_m);
  const Eigen::Vector3d foot = from.position_m + off_m * normal;
  Quantity found;
  found.kind = MeasureKind::kPlane;
  found.value = std::abs(off_m);
  found.surface_sigma =
      std::hypot(from.normal_sigma_m * normal.dot(from.normal), plane.sigma_at_m(foot));
  const double turn_rad = kTurnFloor_rad + kTurnOfWay_rad * std::sqrt(drift->way_m);
  found.pose_sigma = std::hypot(drift->sigma, length_share_of(map) * between_m.norm(),
                                turn_rad * (foot - plane.place.position_m).norm());
  found.way_m = drift->way_m;
  found.half_width = kDeviationsOfConfidence * std::hypot(found.surface_sigma, found.pose_sigma);
  return found;
}

Result<Quantity> angle_between(const MeasuredPlane& from, const MeasuredPlane& to,
                               const MapKnowledge& map) {
  const std::array places{from.place, to.place};
  const std::array<Eigen::Vector3d, 2> no_gradients{Eigen::Vector3d::Zero(),
                                                    Eigen::Vector3d::Zero()};
  const Result<PoseError> drift = pose_error_of(places, no_gradients, map);
  if (!drift.ok()) return drift.error();
  const Eigen::Vector3d axis = from.place.normal.cross(to.place.normal);
  const double turn_rad = std::atan2(axis.norm(), from.place.normal.dot(to.place.normal));
  Quantity found;
  found.kind = MeasureKind::kAngle;
  found.value = 180 - turn_rad * kDegrees;
  found.surface_sigma = kDegrees * std::hypot(turn_sigma_of(from, axis), turn_sigma_of(to, axis));
  found.pose_sigma =
      kDegrees * std::hypot(kTurnFloor_rad, kTurnOfWay_rad * std::sqrt(drift->way_m));
  found.way_m = drift->way_m;
  const double sigma = std::hypot(found.surface_sigma, found.pose_sigma);
  // Near 0 and 180 degrees an error in any direction changes the angle the same way, so the
  // interval is that of a two-dimensional error.
  const bool is_folded =
      std::min(found.value, 180 - found.value) < kDeviationsOfConfidenceIn2d * sigma;
  found.half_width = (is_folded ? kDeviationsOfConfidenceIn2d : kDeviationsOfConfidence) * sigma;
  return found;
}

}  // namespace hermite::measure
