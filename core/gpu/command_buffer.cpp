#include "core/gpu/command_buffer.h"

namespace hermite::gpu {

namespace {

void record_barrier(VkCommandBuffer commands, VkPipelineStageFlags to_stages,
                    VkAccessFlags to_access) {
  constexpr VkPipelineStageFlags kWork =
      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  VkMemoryBarrier barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = to_access;
  vkCmdPipelineBarrier(commands, kWork, to_stages, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

}  // namespace

CommandBuffer::CommandBuffer(Device& device) : device_(device) {
  try {
    VkCommandPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.queueFamilyIndex = device.queue_family();
    throw_if_failed(vkCreateCommandPool(device.vk(), &pool, nullptr, &pool_),
                    "make a command pool");
    VkCommandBufferAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    throw_if_failed(vkAllocateCommandBuffers(device.vk(), &allocate, &buffer_),
                    "make a command buffer");
    VkFenceCreateInfo fence{};
    fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
    throw_if_failed(vkCreateFence(device.vk(), &fence, nullptr, &fence_), "make a fence");
  } catch (...) {
    destroy();
    throw;
  }
}

CommandBuffer::~CommandBuffer() {
  if (device_.may_release()) destroy();
}

void CommandBuffer::destroy() noexcept {
  vkDestroyFence(device_.vk(), fence_, nullptr);
  vkDestroyCommandPool(device_.vk(), pool_, nullptr);
}

VkCommandBuffer CommandBuffer::vk() {
  if (recording_) return buffer_;
  device_.throw_if_lost();  // a hung submission still uses the buffer
  throw_if_failed(vkResetCommandPool(device_.vk(), pool_, 0), "reset a command pool");
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  throw_if_failed(vkBeginCommandBuffer(buffer_, &begin), "begin a command buffer");
  recording_ = true;
  return buffer_;
}

void CommandBuffer::barrier() {
  record_barrier(vk(),
                 VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT |
                     VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                 VK_ACCESS_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_SHADER_READ_BIT |
                     VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                     VK_ACCESS_TRANSFER_WRITE_BIT);
}

void CommandBuffer::run(std::chrono::milliseconds limit, const std::function<void()>& meanwhile) {
  record_barrier(vk(), VK_PIPELINE_STAGE_HOST_BIT,
                 VK_ACCESS_HOST_READ_BIT | VK_ACCESS_HOST_WRITE_BIT);
  recording_ = false;
  throw_if_failed(vkEndCommandBuffer(buffer_), "end a command buffer");
  device_.submit_and_wait(buffer_, fence_, limit, meanwhile);
}

}  // namespace hermite::gpu
