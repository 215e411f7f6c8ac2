// What every writer of a cloud relies on. Pure.
#pragma once

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

// kInvalidArgument, naming the point: a position, normal, confidence, curvature or radius that is not finite; a cloud without a point.
Status check_cloud_with_points(const Cloud& cloud);

}  // namespace hermite
