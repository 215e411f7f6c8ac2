// How well a frame's motion against the map is known, and whether depth, picture and followed corners agree about it. Pure functions of
// values, any thread.
//
// Twists are those of the odometry: reference_from_camera <- exp(x) reference_from_camera, translation [m] and rotation [rad] in the
// reference camera's axes.
#pragma once

#include <string>

#include "core/track/normal_equations.h"

namespace hermite {

// What one kind of residuals says of the motion where the odometry has ended. The system is in the odometry's weights: over `unit`, the
// mean weighted square of a residual, it would be information, were residuals independent.
struct StepWitness {
  NormalEquations system;
  double unit = 0;  // 0: it says nothing
};

struct StepWitnesses {
  StepWitness depth, picture, corners;
  double corner_weight = 0;  // that the corners' system had beside the others; they are a witness also where they had none
};

// Of the motion that all of them together have led to: the sandwich H^-1 (sum of their scores' covariances) H^-1, with as many independent
// residuals as the correlation of their noise leaves. Where nothing holds the camera it is great, never infinite: 0.3 m and 0.5 rad.
Matrix6d step_covariance(const StepWitnesses& witnesses);

// Where one witness alone would have the camera, against all others.
struct Contradiction {
  double sigmas = 0;  // the greatest, of all pairs of witnesses and the directions that both know
  double distance_m = 0, turn_rad = 0;
  const char* first = "";
  const char* second = "";
};
Contradiction contradiction(const StepWitnesses& witnesses);

}  // namespace hermite
