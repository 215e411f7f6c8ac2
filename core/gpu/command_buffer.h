// A command buffer that is recorded, run to completion and reused. For core/gpu only; passes use
// Commands.
#pragma once

#include <vulkan/vulkan.h>

#include <chrono>
#include <functional>

#include "core/gpu/device.h"

namespace hermite::gpu {

class CommandBuffer {
 public:
  explicit CommandBuffer(Device& device);
  ~CommandBuffer();
  CommandBuffer(const CommandBuffer&) = delete;
  CommandBuffer& operator=(const CommandBuffer&) = delete;

  bool recording() const { return recording_; }
  // Returns the buffer to record into, after beginning it if necessary. Throws DeviceError once the
  // device is lost.
  VkCommandBuffer vk();
  // Makes everything recorded before complete and visible to everything recorded after, shaders and
  // transfers alike.
  void barrier();
  // Ends the recording, runs it, does `meanwhile` unless it is empty, and waits. Afterwards mapped
  // pointers see what the GPU wrote. Throws DeviceError, and what `meanwhile` throws; the recorded
  // commands are dropped in any case.
  void run(std::chrono::milliseconds limit = kWaitLimit,
           const std::function<void()>& meanwhile = nullptr);

 private:
  void destroy() noexcept;

  Device& device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  bool recording_ = false;
};

}  // namespace hermite::gpu
