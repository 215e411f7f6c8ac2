// How the GPU says no. Everything in core/gpu that can fail on a working program throws DeviceError; nothing aborts but our own mistakes.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite::gpu {

// Code kDevice. The words say what was asked for and whether the device is lost, hung or out of memory.
class DeviceError : public SetupError {
 public:
  explicit DeviceError(const std::string& words) : SetupError(Error{ErrorCode::kDevice, words}) {}
};

// "the device is lost", "out of GPU memory", or the name of the code: for people.
std::string in_words(VkResult result);

// Throws DeviceError "cannot <action>: <why>" for negative results.
void throw_if_failed(VkResult result, const char* action);

// "1.5 GiB", "12.0 MiB", "512 bytes".
std::string bytes_in_words(std::uint64_t bytes);

}  // namespace hermite::gpu
