// Brightness of a frame's colour image relative to the map. Header only.
#pragma once

namespace hermite::frame {

// Frame value = gain * map value + offset, for grey values and colours from 0 to 255 (exposure,
// light, veiling glare).
struct Brightness {
  double gain = 1, offset = 0;
};

}  // namespace hermite::frame
