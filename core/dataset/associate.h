// Pairs the entries of two lists of times. Pure functions.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/result.h"

namespace hermite::dataset {

// The largest gap between colour and depth, and between estimate and ground truth, in the TUM
// benchmark's tools.
inline constexpr double kMaxAssociationGap_s = 0.020;

struct IndexPair {
  std::size_t first = 0;   // into first_times_s
  std::size_t second = 0;  // into second_times_s
  bool operator==(const IndexPair&) const = default;
};

// Pairs entries like the TUM benchmark's associate.py: of all pairs at most `max_gap_s` apart the
// closest is taken first, then the next closest whose two entries are both free; each entry is used
// once. Ties go to the earlier entries. Both lists must be ascending. The result ascends in
// `first`. kTooLarge when entries are so dense (more than 256 within the gap on average) that the
// lists cannot be time stamps of images or poses.
Result<std::vector<IndexPair>> associate_by_time(const std::vector<double>& first_times_s,
                                                 const std::vector<double>& second_times_s,
                                                 double max_gap_s = kMaxAssociationGap_s);

}  // namespace hermite::dataset
