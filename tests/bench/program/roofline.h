// What a device can do at most, by two small shaders: the measure that passes are judged by.
#pragma once

#include <string>

#include "core/gpu/device_info.h"

namespace hermite::bench {

struct Roofline {
  gpu::DeviceInfo device;
  bool has_timestamps = false;  // else the two are of wall clock
  // Copying buffers too large for caches; bytes read and bytes written.
  double memory_gb_per_s = 0;
  double gflop_per_s = 0;  // single precision; a multiply-add is two
};

// Opens the device (`select` as for Pipeline), measures for a fraction of a second, closes it.
// Throws SetupError.
Roofline measure_roofline(const std::string& select);

}  // namespace hermite::bench
