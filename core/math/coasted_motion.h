// Where a camera is that is not seen for a while. Pure, any thread.
#pragma once

#include "core/math/rigid3.h"

namespace hermite {

struct CoastedMotion {
  Rigid3 seen_from_now;         // the pose relative to when it was last seen
  double position_sigma_m = 0;  // standard deviations along each axis
  double rotation_sigma_rad = 0;
};

// Returns the motion of a camera that had this twist (translation part first) when it was last
// seen. A hand goes on, but less and less. Returns no motion for a duration that is not positive.
CoastedMotion coasted_motion(const Vector6d& twist_per_s, double duration_s);

}  // namespace hermite
