// Thins out a cloud evenly. Pure.
#pragma once

#include <cstddef>

#include "core/output/cloud.h"

namespace hermite::output {

// Returns at most `most` points (at least 1: CHECK), in their order: the most confident one per
// cube of a grid, the finest one that gives so few (edges of 2 mm times powers of 1.25). A cloud
// that is small enough is returned unchanged. Positions must be finite (CHECK).
Cloud thinned(const Cloud& cloud, std::size_t most);

}  // namespace hermite::output
