// Detects where the light on resting surfaces changes: a spot of sun that moves, a shadow, a screen, a highlight. Depth is
// right there, but the image would pull the camera along with the light. Between walls without texture such an edge is
// the strongest one in the image: a spot of 0.6 m moved the camera by half a metre (tests/accuracy/LAB.md).
//
// Pure functions on the host. Any thread.
#pragma once

#include <vector>

#include "core/track/moving_regions.h"

namespace hermite {

// Returns the pixels of the frame, seen from `world_from_camera`, whose brightness contradicts more of the earlier views
// than it agrees with, by connected regions and with the pixels around them. The exposure of each view is unknown. All
// zero if most of the surface contradicts them: then it is the exposure of parts, or the pose, that is wrong. `moving`,
// of the frame's size, is ignored.
CoarseMask changed_light(const CoarseView& frame, const Rigid3& world_from_camera, const CoarseMask& moving,
                         const std::deque<SeenView>& earlier);

}  // namespace hermite
