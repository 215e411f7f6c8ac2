// Is the GPU fit for scanning? What `hermite doctor` says about it, in words for a person.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite {

struct DeviceReport {
  std::vector<std::string> facts;     // lines
  std::vector<std::string> problems;  // lines; empty when scans can run
};

// Lists the devices, opens the one that `device` selects (as for Pipeline), compiles every shader and copies some memory: a few seconds.
// Never throws: what is wrong is a problem. Any thread.
DeviceReport examine_device(const std::string& device);

// Opens the device that scans would use, and closes it: its name. Some milliseconds, more where a driver has to start. kDevice in words.
// Any thread.
Result<std::string> open_device(const std::string& device);

}  // namespace hermite
