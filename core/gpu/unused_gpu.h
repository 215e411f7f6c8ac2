// A GPU of the machine that no Vulkan driver opens, so that scans run on the processor without
// anybody having said so.
#pragma once

#include <string>

#include "core/gpu/device_info.h"

namespace hermite::gpu {

// Returns what may be done about it, in a sentence, if `used` is a processor and the folder of
// device files shows a GPU; empty otherwise. Any thread.
std::string unused_gpu_message(const DeviceInfo& used, const std::string& device_files = "/dev");

}  // namespace hermite::gpu
