// How far apart points lie. Pure; on all processors.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/output/cloud.h"

namespace hermite {

// By point: the edge of the square that each point around it has for itself, r sqrt(pi / k), with r the distance to its k-th neighbour. Of
// several neighbours, since the nearest alone may be a second look at the same place. Positions are finite (CHECK). A cloud with fewer
// points takes those it has; a single point has a spacing of 0.
inline constexpr std::size_t kSpacingNeighbours = 8;
std::vector<float> spacings_of_positions_m(const std::vector<Eigen::Vector3f>& positions_m);
std::vector<float> point_spacings_m(const Cloud& cloud);

}  // namespace hermite
