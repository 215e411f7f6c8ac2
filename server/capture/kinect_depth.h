// What the 11 bits of a Kinect v1 mean, for libraries that hand them on as they are. Pure function.
#pragma once

#include <cstdint>

namespace hermite {

// Millimetres; 0: no measurement (2047, or beyond what the sensor measures). By OpenKinect's fit to many devices,
// z = 1 / (3.3309495161 - 0.0030711016 raw), which is within 1 % of what a device says of itself.
std::uint16_t kinect_depth_mm(std::uint16_t raw);

}  // namespace hermite
