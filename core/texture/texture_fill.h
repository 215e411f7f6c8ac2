// Colours where there are none, from those around. Pure functions.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/image.h"

namespace hermite {

// Every pixel that has no value gets a smooth one from those around it, near ones counting most (pull-push: means over 2 x 2 pixels, again
// and again, and back). 0 everywhere when no pixel has a value. Of one size.
void fill_smoothly(Image<Eigen::Vector3f>& values, const Image<std::uint8_t>& has_value);

}  // namespace hermite
