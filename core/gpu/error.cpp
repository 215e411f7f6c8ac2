#include "core/gpu/error.h"

#include <fmt/core.h>

namespace hermite::gpu {

std::string as_text(VkResult result) {
  switch (result) {
    case VK_SUCCESS: return "success";
    case VK_NOT_READY: return "not ready";
    case VK_TIMEOUT: return "no answer in time";
    case VK_ERROR_OUT_OF_HOST_MEMORY: return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "out of GPU memory";
    case VK_ERROR_INITIALIZATION_FAILED: return "the driver could not be initialised";
    case VK_ERROR_DEVICE_LOST: return "the device is lost";
    case VK_ERROR_MEMORY_MAP_FAILED: return "the memory could not be mapped";
    case VK_ERROR_LAYER_NOT_PRESENT: return "a layer is missing";
    case VK_ERROR_EXTENSION_NOT_PRESENT: return "an extension is missing";
    case VK_ERROR_FEATURE_NOT_PRESENT: return "a feature is missing";
    case VK_ERROR_INCOMPATIBLE_DRIVER: return "no compatible Vulkan driver is installed";
    case VK_ERROR_TOO_MANY_OBJECTS: return "too many allocations";
    case VK_ERROR_INVALID_SHADER_NV: return "the driver refused the shader";
    default: return "Vulkan error " + std::to_string(static_cast<int>(result));
  }
}

void throw_if_failed(VkResult result, const char* action) {
  if (result < 0) throw DeviceError(fmt::format("cannot {}: {}", action, as_text(result)));
}

std::string bytes_as_text(std::uint64_t bytes) {
  constexpr double kMiB = 1024.0 * 1024.0, kGiB = 1024.0 * kMiB;
  const double value = static_cast<double>(bytes);
  if (value >= kGiB) return fmt::format("{:.1f} GiB", value / kGiB);
  if (value >= kMiB) return fmt::format("{:.1f} MiB", value / kMiB);
  return fmt::format("{} bytes", bytes);
}

}  // namespace hermite::gpu
