// What is measured with planes of a result: how far a place lies from one, and the angle that two enclose. Pure functions.
#pragma once

#include "core/base/result.h"
#include "core/measure/plane_fit.h"
#include "core/measure/pose_error.h"
#include "core/measure/quantity.h"

namespace hermite {

// Of a place from a plane, straight across to it, however far the plane goes: its error is that of the place along the plane's normal, that
// of the plane where the place is straight above it, and that of poses between the two. kInvalidArgument, in words: pose_error_of.
Result<Quantity> distance_to_plane(const MeasuredPlace& from, const MeasuredPlane& plane, const MapKnowledge& map);

// That two surfaces enclose, as one sees it between them: 90 degrees in the corner of a room and at the edge of a box, 180 where both are
// one wall, 0 between walls that face each other. kInvalidArgument, in words: pose_error_of.
Result<Quantity> angle_between(const MeasuredPlane& from, const MeasuredPlane& to, const MapKnowledge& map);

}  // namespace hermite
