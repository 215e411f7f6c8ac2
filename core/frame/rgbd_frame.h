// One RGB-D pair as a sensor or a recording gives it: same size, depth registered to colour unless the camera has a Camera::color.
// Plain value.
#pragma once

#include "core/base/image.h"

namespace hermite {

struct RgbdFrame {
  double timestamp_s = 0;  // the recording's own clock
  DepthImage depth;        // sensor units, see Camera::depth_units_per_metre
  ColorImage color;
};

}  // namespace hermite
