// Checks whether a GPU is suitable for scanning, for `hermite doctor`. Prints nothing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/gpu/device_info.h"

namespace hermite::gpu {

struct DeviceCheck {
  DeviceInfo info;
  bool has_timestamps = false;
  bool host_sees_device_memory = false;  // transfers need no staging buffer

  struct Heap {
    std::uint64_t bytes = 0;
    bool device_local = false;
  };
  std::vector<Heap> heaps;

  struct Compiled {
    std::string kernel;
    double compile_ms = 0;
    std::string error;  // empty if it compiled
  };
  // Every embedded shader, except those that need 64-bit atomics if the device has none.
  std::vector<Compiled> kernels;

  // GiB/s of wall-clock time for 32 MiB (less where buffers are smaller).
  double upload_gib_per_s = 0, download_gib_per_s = 0, device_copy_gib_per_s = 0;
  double submission_us = 0;  // wall-clock time of one tiny submission

  std::vector<std::string> problems;  // as text; empty when the device is suitable
};

// Opens the device (`select` as for Device), compiles, copies and measures; takes one or two
// seconds. Throws SetupError(kDevice) when the device cannot be opened; later failures are listed
// in `problems`. Blocks. Any thread.
DeviceCheck check_device(const std::string& select);

}  // namespace hermite::gpu
