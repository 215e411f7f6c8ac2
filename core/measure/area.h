// The area of a polygon whose corners are places of a result, and its uncertainty. Pure function.
#pragma once

#include <span>

#include "core/base/result.h"
#include "core/measure/pose_error.h"
#include "core/measure/quantity.h"

namespace hermite::measure {

// Returns the area in the best-fitting plane of the corners, onto which they are projected.
// `corners` are 3 to kMostCorners, in the order of the outline, in either direction; the last one
// is connected with the first. The error of the area comes from the error of each corner along its
// normal, as far as that lies in the plane, and from the poses. kInvalidArgument when two
// neighbouring corners are one place, when all lie on one line or the outline crosses or touches
// itself (the message counts corners from 1), and as for pose_error_of.
Result<Quantity> area_of(std::span<const MeasuredPlace> corners, const MapKnowledge& map);

}  // namespace hermite::measure
