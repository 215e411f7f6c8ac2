// The spacing of points. Pure; uses all processors.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/output/cloud.h"

namespace hermite::output {

// Number of neighbours, k, from which the spacing of points is estimated.
inline constexpr std::size_t kSpacingNeighbours = 8;

// Returns for each point the edge of the square that each point around it occupies, r sqrt(pi / k),
// where r is the distance to its k-th neighbour. It uses several neighbours, because the nearest
// may be a repeated observation of the same place. Positions must be finite (CHECK). A smaller
// cloud uses all its points; a single point has a spacing of 0.
std::vector<float> spacings_of_positions_m(const std::vector<Eigen::Vector3f>& positions_m);
std::vector<float> point_spacings_m(const Cloud& cloud);

}  // namespace hermite::output
