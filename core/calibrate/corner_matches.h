// Matching of image corners between two views.
#pragma once

#include <optional>
#include <vector>

#include "core/adjust/features.h"
#include "core/adjust/projection_match.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite::calibrate {

// Gates of correspondences. The scale of Cauchy's loss is a third of the gate, so a residual at the
// gate has a tenth of its weight.
struct MeasurementGates {
  double surface_m = 0, corner_px = 0;
};

// Returns the position of the feature in its camera frame [m], with the camera's depth correction;
// nullopt without depth.
std::optional<Eigen::Vector3d> point_of(const adjust::Feature& feature, const Camera& camera);

// Matches each feature of the source that has depth with the one of the target, within the gate of
// its projection, whose descriptor is nearest, within the bounds of ProjectionOptions. Rejects
// pairs whose depths differ by more than twice the surface's gate and noise.
// LandmarkMatch::landmark is the index in the source. Each feature is used at most once. `camera`
// has no lens distortion. Pure; any thread.
std::vector<adjust::LandmarkMatch> match_corners(const std::vector<adjust::Feature>& source,
                                                 const std::vector<adjust::Feature>& target,
                                                 const Rigid3& target_from_source,
                                                 const Camera& camera,
                                                 const MeasurementGates& gates);

// Returns the same match with source and target exchanged.
inline adjust::LandmarkMatch reversed(const adjust::LandmarkMatch& match) {
  return {.feature = match.landmark, .landmark = match.feature, .distance = match.distance};
}

}  // namespace hermite::calibrate
