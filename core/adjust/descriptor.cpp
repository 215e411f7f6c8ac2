#include "core/adjust/descriptor.h"

#include <algorithm>

#include "core/base/check.h"

namespace hermite::adjust {

std::size_t medoid(const std::vector<Descriptor>& descriptors) {
  CHECK(!descriptors.empty(), "the medoid of an empty list was requested");
  std::size_t best = 0;
  int best_median = kDescriptorBits + 1;
  std::vector<int> distances(descriptors.size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    for (std::size_t j = 0; j < descriptors.size(); ++j)
      distances[j] = hamming(descriptors[i], descriptors[j]);
    // Its distance to itself is included, so this is the median of the others, rounded down.
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < best_median) {
      best_median = *middle;
      best = i;
    }
  }
  return best;
}

}  // namespace hermite::adjust
