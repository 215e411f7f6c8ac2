// What the values of depth images say about the sensor and its unit. Plain values; the class is for one thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace hermite {

struct DepthSurvey {
  double valid_share = 0;                               // of all pixels
  std::uint16_t nearest = 0, median = 0, farthest = 0;  // sensor units: 1, 50 and 99 % of the valid values are at most these
  std::int64_t distinct_values = 0;
  std::uint16_t common_divisor = 0;  // of all values; 0 without one
};

// Collects the values of as many images as it is given; 512 KiB.
class DepthValues {
 public:
  void add(const DepthImage& depth);
  DepthSurvey survey() const;

 private:
  std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(65536);
};

// The unit that the values make likely, and why. Rooms are seen from 0.3 to 6 m: a stated unit that puts the median there is believed, else
// the common one that does.
struct UnitGuess {
  double units_per_metre = 0;
  std::string reason;
  bool is_doubtful = false;  // another than stated, or none fits
};
UnitGuess guess_depth_unit(const DepthSurvey& survey, double stated_units_per_metre);

}  // namespace hermite
