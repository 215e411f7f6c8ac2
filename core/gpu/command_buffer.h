// A command buffer that is recorded, run to its end and used again. For core/gpu only: passes use Commands.
#pragma once

#include <vulkan/vulkan.h>

#include <chrono>

#include "core/gpu/device.h"

namespace hermite::gpu {

class CommandBuffer {
 public:
  explicit CommandBuffer(Device& device);
  ~CommandBuffer();
  CommandBuffer(const CommandBuffer&) = delete;
  CommandBuffer& operator=(const CommandBuffer&) = delete;

  bool recording() const { return recording_; }
  // The buffer to record into; begins it if need be. Throws DeviceError once the device is lost.
  VkCommandBuffer vk();
  // Everything recorded before is done and seen by everything recorded after, shaders and transfers alike.
  void barrier();
  // Ends, runs, waits. What the GPU wrote is then seen by mapped pointers. Throws DeviceError; recorded commands are dropped either way.
  void run(std::chrono::milliseconds limit = kWaitLimit);

 private:
  void destroy() noexcept;

  Device& device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  bool recording_ = false;
};

}  // namespace hermite::gpu
