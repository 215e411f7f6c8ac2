#include "core/measure/pose_error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/check.h"

namespace hermite::measure {

namespace {

// What remains between places that one camera has seen, the share of the distance, and what grows
// with the square root of the path length. Measured.
constexpr double kPoseFloor_m = 0.00015, kOfDistance = 0.0004, kOfWay_m = 0.0005;

// Remaining error of the focal length of a corrected camera (kFittingFocal of
// core/calibrate/camera_watch.h), as a share.
constexpr double kOfCorrectedCamera = 0.0015;

// The expected error of the path up to which these factors hold. Of the scenes for which they were
// measured, one walk of the loop expects 7 mm and bare walls 4 to 11 mm, the others less
// (tests/accuracy/README.md, "Expected error").
constexpr double kOrdinaryPath_m = 0.012;

}  // namespace

Result<PoseError> pose_error_of(std::span<const MeasuredPlace> places,
                                std::span<const Eigen::Vector3d> gradients,
                                const MapKnowledge& map) {
  CHECK(places.size() == gradients.size(), "a derivative for each place");
  std::vector<std::vector<bool>> seen;
  for (const MeasuredPlace& place : places) {
    if (map.part_count > 1 && place.submap != places.front().submap)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("the scan is in {} parts, since the camera was lost between them, "
                               "and the points need not be in the same one",
                               map.part_count)};
    seen.push_back(map.way.seen_from(place.position_m, place.normal));
  }
  PoseError error;
  double variance = 0;
  const double of_way_m = kOfWay_m * std::max(1.0, map.expected_path_m / kOrdinaryPath_m);
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double way_m = map.way.between_m(seen[i], seen[j]);
      if (!std::isfinite(way_m))
        return Error{ErrorCode::kInvalidArgument,
                     "no camera of the scan's path can have seen one of the points: nothing is "
                     "known of its error"};
      error.way_m = std::max(error.way_m, way_m);
      variance -= gradients[i].dot(gradients[j]) *
                  (kPoseFloor_m * kPoseFloor_m + of_way_m * of_way_m * way_m);
    }
  error.sigma = std::sqrt(std::max(0.0, variance));
  return error;
}

double length_share_of(const MapKnowledge& map) {
  return std::hypot(kOfDistance, map.camera_was_corrected ? kOfCorrectedCamera : 0);
}

}  // namespace hermite::measure
