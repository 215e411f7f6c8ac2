// Poses for frames that were lost between two that were not. Their status stays lost: nothing has
// measured them, but whoever reads a trajectory line by line is nearer to the truth so than with
// the pose before the loss.
#pragma once

#include <cstddef>
#include <vector>

#include "core/adjust/mapping.h"
#include "core/pipeline/frame_result.h"

namespace hermite::pipeline {

// If the last pose is not of a lost frame and those before it are, places these between the last
// two that are not lost, as if the camera had moved at constant velocity. Returns the index of the
// first pose that has changed; poses.size() if none has, also because the two belong to components
// of the map whose relative pose is not known. Until then a lost frame has the pose before it.
// Pure, any thread.
std::size_t place_lost_frames(std::vector<AnchoredPose>& poses, const adjust::MapLayout& layout);

}  // namespace hermite::pipeline
