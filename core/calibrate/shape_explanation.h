// Which errors of a camera's shape explain its views, where a dozen views confuse focal length,
// distortion and bend. A pure function, any thread.
#pragma once

#include <optional>

#include "core/calibrate/camera_question.h"

namespace hermite::calibrate {

struct Explanation {
  FreeNumbers is_free{};
  JointSolution solution;
};

// Returns the fewest errors that explain the views if a distortion of the lens is one of them;
// nullopt if none is. `without` is the explanation without a distortion.
std::optional<Explanation> lens_of(const Question& question, const Explanation& without);

}  // namespace hermite::calibrate
