// The preconditions of every cloud writer. Pure.
#pragma once

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite::output {

// Returns kInvalidArgument, naming the point, when a position, normal, confidence, curvature or
// radius is not finite, or when the cloud is empty.
Status check_cloud_with_points(const Cloud& cloud);

}  // namespace hermite::output
