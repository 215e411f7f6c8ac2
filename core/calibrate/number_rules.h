// What may be an error of a camera: how large each parameter's error usually is, when it is
// significant, and when it matters. Pure functions, any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/calibrate/camera_numbers.h"
#include "core/calibrate/joint_adjustment.h"

namespace hermite::calibrate {

// A change is significant from so many standard deviations on.
inline constexpr double kLeastDeviations = 3;

// Returns the name of a CameraNumber, see FoundNumber.
const char* name_of_number(std::size_t number);

// Returns the standard deviation of a parameter's error before anything is measured, in the units
// of CameraVector.
double prior_deviation(std::size_t number, const Camera& camera);

// A parameter that must not stay free, and why.
struct Objection {
  std::size_t number = 0;
  std::string reason;
};

// Returns the parameters that must not stay free: those that are clearly not needed, or else the
// one with the strongest objection, because the others may be needed without it. Empty if all may
// stay free.
std::vector<Objection> objections_to(const JointSolution& solution, const FreeNumbers& is_free,
                                     const Camera& camera);

}  // namespace hermite::calibrate
