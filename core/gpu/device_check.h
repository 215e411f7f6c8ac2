// Is this GPU fit for scanning? What `hermite doctor` reports. Nothing here prints.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/gpu/device_info.h"

namespace hermite::gpu {

struct DeviceCheck {
  DeviceInfo info;
  bool has_timestamps = false;
  bool host_sees_device_memory = false;  // transfers need no staging copy

  struct Heap {
    std::uint64_t bytes = 0;
    bool device_local = false;
  };
  std::vector<Heap> heaps;

  struct Compiled {
    std::string kernel;
    double compile_ms = 0;
    std::string error;  // empty when it compiled
  };
  std::vector<Compiled> kernels;  // every embedded shader, but those for 64-bit atomics that the device has not

  // GiB/s of wall clock for 32 MiB (less where buffers are smaller).
  double upload_gib_per_s = 0, download_gib_per_s = 0, device_copy_gib_per_s = 0;
  double submission_us = 0;  // wall clock of one tiny submission, start to end

  std::vector<std::string> problems;  // in words; empty when the device is fit
};

// Opens the device (`select` as for Device), compiles, copies, measures: a second or two. Throws SetupError(kDevice) when it cannot be
// opened; what fails later is one of `problems`. Blocks; any thread.
DeviceCheck check_device(const std::string& select);

}  // namespace hermite::gpu
