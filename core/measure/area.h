// The area of a polygon whose corners are places of a result, and how well it is known. Pure function.
#pragma once

#include <span>

#include "core/base/result.h"
#include "core/measure/pose_error.h"
#include "core/measure/quantity.h"

namespace hermite {

// In the plane that fits the corners best, onto which they are brought straight. `corners` are 3 to kMostCorners, in the order of the
// outline, either way around; the last one is connected with the first. The error of the area is that of each corner along its normal, as
// far as that lies in the plane, and that of poses. kInvalidArgument, in words that name the corners from 1 on: two neighbours are one
// place; all lie on one line; the outline crosses or touches itself; pose_error_of.
Result<Quantity> area_of(std::span<const MeasuredPlace> corners, const MapKnowledge& map);

}  // namespace hermite
