// Uncertainty of a frame's motion relative to the map, and whether depth, image and followed
// corners agree about it. Pure functions of values. Any thread.
//
// Twists are those of the odometry: reference_from_camera <- exp(x) reference_from_camera,
// translation [m] and rotation [rad] in the reference camera frame.
#pragma once

#include <string>

#include "core/track/normal_equations.h"

namespace hermite::track {

// What one kind of residuals says about the motion at the odometry's result. The system has the
// odometry's weights; divided by `unit`, the mean weighted square of a residual, it would be
// information if residuals were independent.
struct StepWitness {
  NormalEquations system;
  double unit = 0;  // 0: no evidence
};

struct StepWitnesses {
  StepWitness depth{}, image{}, corners{};
  // Weights that the odometry gave to these two besides. Corners are evidence even where it is 0.
  double image_weight = 1, corner_weight = 0;
  // Of the points of depth and image, see normal_equations.h. Zero: their noise is not discounted.
  Matrix6d displacement = Matrix6d::Zero();
};

// Returns the covariance of the motion that all of them have led to: the sandwich H^-1 (sum of
// their scores' covariances) H^-1, with as many independent residuals as the correlation of their
// noise leaves, and of depth and image only what they know beyond noise: noise that stays with the
// camera says, and agrees with itself, that a camera before a blank wall stands still. Where
// nothing constrains the camera it is large but finite: 0.3 m and 0.5 rad.
Matrix6d step_covariance(const StepWitnesses& witnesses);

// The largest difference between the motions that two kinds of residuals give alone.
struct Contradiction {
  double sigmas = 0;  // the largest over all pairs and all directions that both determine
  double distance_m = 0, turn_rad = 0;
  const char* first = "";
  const char* second = "";
};
Contradiction contradiction(const StepWitnesses& witnesses);

}  // namespace hermite::track
