// Validation of a bundle problem before it is solved, and connectivity of its submaps.
#pragma once

#include "core/adjust/bundle.h"

namespace hermite::adjust {

// Returns kInvalidArgument naming the field; see adjust() in bundle.h. Does not check that submaps
// are connected to a fixed one.
Status validate(const BundleProblem& problem, const BundleOptions& options);

// Returns for each submap whether links, or landmarks seen from two submaps, connect it to a fixed
// one. Only observations marked as used count, and fixed submaps are connected. The problem must be
// valid.
std::vector<bool> tied_to_fixed(const BundleProblem& problem,
                                const std::vector<bool>& observation_is_used);

}  // namespace hermite::adjust
