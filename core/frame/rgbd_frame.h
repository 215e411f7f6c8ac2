// An RGB-D pair from a sensor or a recording. Both images have the same size, and depth is
// registered to colour unless the camera has a Camera::color. Plain value.
#pragma once

#include "core/base/image.h"

namespace hermite::frame {

struct RgbdFrame {
  double timestamp_s = 0;  // in the clock of the recording
  DepthImage depth;        // sensor units, see Camera::depth_units_per_metre
  ColorImage color;
};

}  // namespace hermite::frame
