#include "core/adjust/bundle_noise.h"

#include <algorithm>

namespace hermite {

double depth_deviation_m(double depth_m) {
  constexpr double kLeast_m = 0.001;
  return std::max(kLeast_m, (0.00273 * depth_m + 0.00074) * depth_m - 0.00058);
}

}  // namespace hermite
