#include "core/measure/distance.h"

#include <cmath>

#include "core/base/printf_text.h"

namespace hermite {

namespace {

constexpr double kDeviationsOf95 = 1.96;

// Of the poses: what is left between places that one camera has seen, the share of the distance, and what grows with the root of the way.
// Measured.
constexpr double kPoseFloor_m = 0.00015, kOfDistance = 0.0004, kOfWay_m = 0.0005;

// What is left of the focal length's error in a camera that was corrected (kFittingFocal of core/calibrate/camera_watch.h), as a share.
constexpr double kOfCorrectedCamera = 0.0015;

}  // namespace

Result<Distance> distance_between(const MeasuredPlace& from, const MeasuredPlace& to, const MapKnowledge& map) {
  const Eigen::Vector3d between_m = to.position_m - from.position_m;
  Distance found;
  found.distance_m = between_m.norm();
  if (!(found.distance_m >= kLeastDistance_m))
    return Error{ErrorCode::kInvalidArgument, "the two points are the same place: they are less than 5 mm apart"};
  if (map.part_count > 1 && from.submap != to.submap)
    return Error{ErrorCode::kInvalidArgument,
                 "the scan is in " + std::to_string(map.part_count) +
                     " parts, since the camera was lost between them, and the two points need not be in the same one"};
  found.way_m = map.way.between_m(from.position_m, from.normal, to.position_m, to.normal);
  if (!std::isfinite(found.way_m))
    return Error{ErrorCode::kInvalidArgument,
                 "no camera of the scan's path can have seen one of the points: nothing is known of its error"};
  const Eigen::Vector3d direction = between_m / found.distance_m;
  found.surface_sigma_m = std::hypot(from.normal_sigma_m * direction.dot(from.normal), to.normal_sigma_m * direction.dot(to.normal));
  const double share = std::hypot(kOfDistance, map.camera_was_corrected ? kOfCorrectedCamera : 0);
  found.pose_sigma_m = std::hypot(kPoseFloor_m, share * found.distance_m, kOfWay_m * std::sqrt(found.way_m));
  found.half_width_m = kDeviationsOf95 * std::hypot(found.surface_sigma_m, found.pose_sigma_m);
  return found;
}

std::string words_of(const Distance& distance) {
  return printf_text("%.3f m ± %.3f m (95 %%)", distance.distance_m, std::ceil(distance.half_width_m * 1000) / 1000);
}

}  // namespace hermite
