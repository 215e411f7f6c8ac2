// Fills pixels without a value from those around them. Pure functions.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/image.h"

namespace hermite::texture {

// Pull-push interpolation: pixels without a value get a smooth one from their surroundings, with
// most weight for near pixels (a pyramid of means over 2 x 2 pixels, and back). 0 everywhere if no
// pixel has a value. Both images have the same size.
void fill_smoothly(Image<Eigen::Vector3f>& values, const Image<std::uint8_t>& has_value);

}  // namespace hermite::texture
