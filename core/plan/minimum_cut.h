// The cheapest way to divide things into those inside and those outside (Boykov and Kolmogorov,
// PAMI 2004). Pure function. Any thread.
#pragma once

#include <cstddef>
#include <vector>

namespace hermite::plan {

// All costs are at least 0.
struct SideCost {
  double inside = 0, outside = 0;  // what it costs that it is there
};
struct BoundaryCost {
  std::size_t inside = 0, outside = 0;  // indices of two things
  double cost = 0;                      // that the first is inside and the second is not
};

// Returns for each thing whether it is inside; where both are equally cheap, it is not.
std::vector<bool> minimum_cut(const std::vector<SideCost>& things,
                              const std::vector<BoundaryCost>& boundaries);

}  // namespace hermite::plan
