// The connection to the Vulkan loader, and the properties of each physical device. Used only by
// device.cpp.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/gpu/device_info.h"

namespace hermite::gpu {

// Owns the VkInstance and, with validation, the messenger. Not movable, because the messenger holds
// its address.
class Instance {
 public:
  // Throws SetupError(kDevice) when there is no loader of Vulkan 1.2 or no driver.
  Instance();
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  struct Candidate {
    VkPhysicalDevice handle = VK_NULL_HANDLE;
    DeviceInfo info;
  };
  std::vector<Candidate> candidates() const;

  bool validation_active() const { return messenger_ != VK_NULL_HANDLE; }
  std::int64_t validation_error_count() const { return validation_error_count_; }
  // Called by the layer, from any thread.
  void note_validation_error() { ++validation_error_count_; }

 private:
  void create(bool with_validation);

  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::atomic<std::int64_t> validation_error_count_ = 0;
};

// Returns the first queue family with compute support; -1 if there is none.
int find_compute_family(VkPhysicalDevice device);

}  // namespace hermite::gpu
