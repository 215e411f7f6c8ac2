// Possible problems with the depth of a recording or a camera, as sentences for the user. Pure
// function.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/evaluate/depth_survey.h"
#include "core/evaluate/registration_check.h"

namespace hermite::evaluate {

struct DepthFindings {
  DepthSurvey survey;
  UnitGuess unit;
  std::optional<RegistrationFit> registration;  // nullopt: not examined, or too few edges
  double units_per_metre = 1000;                // as stated
};

// Returns doubts about unit, share of valid pixels, range and registration; empty if there are
// none.
std::vector<std::string> depth_doubts(const DepthFindings& found);

}  // namespace hermite::evaluate
