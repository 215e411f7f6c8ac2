// Corners of the picture that two views have in common.
#pragma once

#include <optional>
#include <vector>

#include "core/adjust/features.h"
#include "core/adjust/projection_match.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

// Where the feature lies, in its camera [m], by the camera's correction of depth; none without depth.
std::optional<Eigen::Vector3d> point_of(const Feature& feature, const Camera& camera);

// Of each feature of the source with depth that one of the target, within `gate_px` of where the poses put it, whose descriptor is nearest,
// with the bounds of ProjectionOptions; not where both depths are farther apart than twice `gate_m` and noise. LandmarkMatch::landmark is
// the index in the source. Each feature at most once. `camera` has no lens distortion. Pure; any thread.
std::vector<LandmarkMatch> match_corners(const std::vector<Feature>& source, const std::vector<Feature>& target,
                                         const Rigid3& target_from_source, const Camera& camera, double gate_px, double gate_m);

}  // namespace hermite
