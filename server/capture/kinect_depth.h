// Converts the 11-bit raw depth of a Kinect v1, for libraries that pass it on unchanged. Pure
// function.
#pragma once

#include <cstdint>

namespace hermite::client {

// Returns millimetres; 0: no measurement (2047, or beyond the sensor's range). Uses OpenKinect's
// fit to many devices, z = 1 / (3.3309495161 - 0.0030711016 raw), which is within 1 % of the
// calibration of a device.
std::uint16_t kinect_depth_mm(std::uint16_t raw);

}  // namespace hermite::client
