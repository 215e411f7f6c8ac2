// Fewer points, spread evenly. Pure.
#pragma once

#include <cstddef>

#include "core/output/cloud.h"

namespace hermite {

// At most `most` points (at least 1: CHECK), in their order: one, the most confident, for each cube of a grid, the finest that leaves so
// few (edges of 2 mm times powers of 1.25). A cloud that is small enough is returned as it is. Positions are finite (CHECK).
Cloud thinned(const Cloud& cloud, std::size_t most);

}  // namespace hermite
