// Joint adjustment of view poses and camera parameters by Gauss-Newton, with distances of points of
// one view to planes of another, and with image corners seen in both. Correspondences are renewed
// with decreasing gates; the first gates are as wide as the errors of poses that were estimated
// with a wrong camera.
//
// Deterministic for any number of threads: pairs are evaluated separately and added in their order.
#pragma once

#include <cstdint>
#include <vector>

#include "core/calibrate/camera_numbers.h"
#include "core/calibrate/view_measurement.h"
#include "core/math/rigid3.h"

namespace hermite::calibrate {

struct JointOptions {
  FreeNumbers is_free{};
  CameraVector prior_deviation = CameraVector::Ones();  // of the change, whose prior mean is 0
  unsigned thread_count = 1;                            // at least 1; does not affect the result
};

struct JointSolution {
  // By view; the first view and views without pairs do not move.
  std::vector<Rigid3> world_from_camera;
  CameraVector change = CameraVector::Zero();
  // Standard deviation of the change. Residuals within a pair are correlated, as are pairs with a
  // common view. It is therefore estimated from the scatter of whole pairs' gradients, with pairs
  // that share a view taken together (the dyadic sandwich estimator of Aronow, Samii, Assenova
  // 2015).
  CameraVector deviation = CameraVector::Zero();
};

// Adjusts poses and the free parameters. `camera` is that of the rectified frames, with the depth
// correction from which the change starts. `start` is a solution of the same problem with other
// free parameters, from which the widest gates are not needed. Takes about 0.1 s of CPU time per
// step for 40 views and 300 pairs, and 5 to 15 steps. A CHECK fails if an index of a pair is out of
// range.
JointSolution adjust_jointly(const std::vector<CalibrationView>& views,
                             const std::vector<ViewPair>& pairs, const Camera& camera,
                             const JointOptions& options, const JointSolution* start = nullptr);

}  // namespace hermite::calibrate
