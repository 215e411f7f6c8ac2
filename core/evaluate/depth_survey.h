// Statistics of depth values, and what they say about the sensor and its unit. Plain values; the
// class is for one thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace hermite::evaluate {

struct DepthSurvey {
  double valid_share = 0;  // of all pixels
  // Sensor units: 1, 50 and 99 % of the valid values are at most these.
  std::uint16_t nearest = 0, median = 0, farthest = 0;
  std::int64_t distinct_values = 0;
  std::uint16_t common_divisor = 0;  // of all values; 0 if there are none
};

// Collects the values of any number of images in 512 KiB.
class DepthValues {
 public:
  void add(const DepthImage& depth);
  DepthSurvey survey() const;

 private:
  std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(65536);
};

// The most likely unit, with a reason. Rooms are seen from 0.3 to 6 m: if the stated unit puts the
// median into this range it is accepted, otherwise the common unit that does.
struct UnitGuess {
  double units_per_metre = 0;
  std::string reason;
  bool is_doubtful = false;  // differs from the stated unit, or no unit fits
};
UnitGuess guess_depth_unit(const DepthSurvey& survey, double stated_units_per_metre);

}  // namespace hermite::evaluate
