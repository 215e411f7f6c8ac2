// Measures with planes of a result: the distance of a place from a plane, and the angle between two
// planes. Pure functions.
#pragma once

#include "core/base/result.h"
#include "core/measure/plane_fit.h"
#include "core/measure/pose_error.h"
#include "core/measure/quantity.h"

namespace hermite::measure {

// Returns the perpendicular distance of a place from a plane, which is taken to extend infinitely.
// The error consists of that of the place along the plane's normal, that of the plane at the foot
// of the perpendicular, and that of poses between the two. kInvalidArgument as for pose_error_of.
Result<Quantity> distance_to_plane(const MeasuredPlace& from, const MeasuredPlane& plane,
                                   const MapKnowledge& map);

// Returns the angle that two surfaces enclose, as seen between them: 90 degrees in the corner of a
// room and at the edge of a box, 180 if both are one wall, 0 between walls that face each other.
// kInvalidArgument as for pose_error_of.
Result<Quantity> angle_between(const MeasuredPlane& from, const MeasuredPlane& to,
                               const MapKnowledge& map);

}  // namespace hermite::measure
