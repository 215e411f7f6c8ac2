// The poses from which the alignment of a frame with the map is tried. Pure functions, any thread.
#pragma once

#include <vector>

#include "core/math/rigid3.h"
#include "core/track/feature_motion.h"
#include "core/track/track_options.h"

namespace hermite::track {

// Returns guesses of reference_from_camera: from the corners (nullptr: none) or, without their
// translation, the image's rotation, and the last motion continued.
std::vector<Rigid3> pose_guesses(const Rigid3& turned, const Rigid3& last_motion,
                                 const FeatureMotion* corners, const TrackOptions& options);

// Returns the guesses, followed by rotations of up to a third of a usual field of view in all
// directions, for a camera that is lost.
std::vector<Rigid3> with_turns(std::vector<Rigid3> guesses);

}  // namespace hermite::track
