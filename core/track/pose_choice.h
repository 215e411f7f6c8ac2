// Which of several alignments of a frame with the map is the right one. Pure functions, any thread.
#pragma once

#include <vector>

#include "core/track/odometry.h"
#include "core/track/track_options.h"

namespace hermite::track {

// Adds the result, unless the same pose is there already, of which the better fit stays.
void add_pose(std::vector<OdometryResult>& poses, OdometryResult result);

// Returns the pose that fits best, by how much of the frame agrees in depth and how well its image
// fits there. It is ambiguous if another believable one fits nearly as well. `poses` must not be
// empty.
OdometryResult best_pose(std::vector<OdometryResult> poses, const TrackOptions& options);

}  // namespace hermite::track
