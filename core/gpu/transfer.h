// Moves bytes between the host and memory that the host cannot see, in pieces through one staging buffer. For core/gpu only.
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

  // Each runs and waits. Throws DeviceError.
  void upload(const void* source, VkBuffer target, VkDeviceSize first_byte, std::size_t bytes);
  void download(VkBuffer source, VkDeviceSize first_byte, void* target, std::size_t bytes);
  void fill_with_zero(VkBuffer target);

 private:
  RawBuffer& staging();

  Device& device_;
  CommandBuffer commands_;
  std::unique_ptr<RawBuffer> staging_;  // made at first use: devices whose memory the host sees never need it
};

}  // namespace hermite::gpu
