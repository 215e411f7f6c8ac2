// GPU errors. Everything in core/gpu that can fail in a correct program throws DeviceError; only
// programming errors abort.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite::gpu {

// Its code is kDevice. The message says what was requested and whether the device is lost, hung or
// out of memory.
class DeviceError : public SetupError {
 public:
  explicit DeviceError(const std::string& message)
      : SetupError(Error{ErrorCode::kDevice, message}) {}
};

// Returns "the device is lost", "out of GPU memory", or the name of the code.
std::string as_text(VkResult result);

// Throws DeviceError "cannot <action>: <why>" for negative results.
void throw_if_failed(VkResult result, const char* action);

// Returns a text such as "1.5 GiB", "12.0 MiB" or "512 bytes".
std::string bytes_as_text(std::uint64_t bytes);

}  // namespace hermite::gpu
