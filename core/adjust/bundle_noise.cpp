#include "core/adjust/bundle_noise.h"

#include <algorithm>

namespace hermite::adjust {

double depth_deviation_m(double depth_m) {
  constexpr double kLeast_m = 0.001;
  return std::max(kLeast_m, (0.00273 * depth_m + 0.00074) * depth_m - 0.00058);
}

double weight_of_observation(std::size_t observation_count, double focal_length_px) {
  if (observation_count < 2) return 1;
  const double alike_px = focal_length_px * kTracked_rad;
  const double correlation = alike_px * alike_px / (alike_px * alike_px + 1);
  return 1 / (1 + static_cast<double>(observation_count - 1) * correlation);
}

}  // namespace hermite::adjust
