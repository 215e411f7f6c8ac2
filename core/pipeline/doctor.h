// Checks whether the GPU is suitable for scanning, for `hermite doctor`; the report is text for
// people.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::pipeline {

struct DeviceReport {
  std::vector<std::string> facts;     // one line each
  std::vector<std::string> problems;  // one line each; empty when scans can run
};

// Lists the devices, opens the one that `device` selects (as for Pipeline), compiles every shader
// and copies some memory, which takes a few seconds. Never throws: failures become problems. Any
// thread.
DeviceReport examine_device(const std::string& device);

struct OpenedDevice {
  std::string name;
  // What may be done about a GPU that is not used (core/gpu/unused_gpu.h); empty: nothing.
  std::string unused_gpu;
};

// Opens the device that scans would use and closes it. Takes some milliseconds, more if a driver
// has to start. Returns kDevice when it cannot be opened. Any thread.
Result<OpenedDevice> open_device(const std::string& device);

}  // namespace hermite::pipeline
