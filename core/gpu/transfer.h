// Copies bytes between the host and memory that the host cannot access, in pieces through one
// staging buffer. For core/gpu only.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <memory>

#include "core/gpu/command_buffer.h"

namespace hermite::gpu {

class RawBuffer;

class Transfer {
 public:
  explicit Transfer(Device& device);
  ~Transfer();

  // Each call runs and waits. Throws DeviceError.
  void upload(const void* source, VkBuffer target, VkDeviceSize first_byte, std::size_t bytes);
  void download(VkBuffer source, VkDeviceSize first_byte, void* target, std::size_t bytes);
  void fill_with_zero(VkBuffer target);

 private:
  RawBuffer& staging();

  Device& device_;
  CommandBuffer commands_;
  // Allocated at first use; devices whose memory the host can access never need it.
  std::unique_ptr<RawBuffer> staging_;
};

}  // namespace hermite::gpu
