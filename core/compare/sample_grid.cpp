#include "core/compare/sample_grid.h"

namespace hermite::compare {

std::optional<std::uint32_t> SampleGrid::nearest(const Eigen::Vector3d& point,
                                                 const Eigen::Vector3d& normal, double reach_m,
                                                 double least_cosine) const {
  std::optional<std::uint32_t> found;
  double least2_m2 = 0;
  for_each_within(point, reach_m, [&](std::uint32_t i) {
    if (samples_[i].normal.dot(normal) < least_cosine) return;
    const double distance2_m2 = (samples_[i].position_m - point).squaredNorm();
    if (found && distance2_m2 >= least2_m2) return;
    found = i;
    least2_m2 = distance2_m2;
  });
  return found;
}

}  // namespace hermite::compare
