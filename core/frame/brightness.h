// How bright a frame's picture is beside the map's. Header only.
#pragma once

namespace hermite {

// Grey values and colours, 0 to 255: of the frame = gain * of the map + offset (exposure, light, veiling glare).
struct Brightness {
  double gain = 1, offset = 0;
};

}  // namespace hermite
