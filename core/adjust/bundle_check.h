// What a bundle problem must fulfil before it is solved, and which submaps hang together.
#pragma once

#include "core/adjust/bundle.h"

namespace hermite {

// kInvalidArgument, naming the field; see adjust() in bundle.h. Does not look at what ties submaps together.
Status validate(const BundleProblem& problem, const BundleOptions& options);

// For each submap: do links, and landmarks that two submaps see, tie it to a fixed one? Only observations marked as used count. Fixed
// submaps are tied. The problem must be valid.
std::vector<bool> tied_to_fixed(const BundleProblem& problem, const std::vector<bool>& observation_is_used);

}  // namespace hermite
