// What may be wrong with the depth of a recording or a camera, in sentences for the user. Pure function.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/evaluate/depth_survey.h"
#include "core/evaluate/registration_check.h"

namespace hermite {

struct DepthFindings {
  DepthSurvey survey;
  UnitGuess unit;
  std::optional<RegistrationFit> registration;  // none: not looked at, or too few edges
  double units_per_metre = 1000;                // as stated
};

// Unit, share of valid pixels, range, registration; empty without a doubt.
std::vector<std::string> depth_doubts(const DepthFindings& found);

}  // namespace hermite
