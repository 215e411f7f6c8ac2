// What kernels bind, for devices without push descriptors: sets for one list of commands, taken back all at once. For core/gpu only.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gpu/device.h"

namespace hermite::gpu {

inline constexpr std::uint32_t kMaxBindings = 32;  // of a kernel

// Owns the pools, which grow in number to the longest list seen; must die before its device. One thread at a time.
class DescriptorSets {
 public:
  explicit DescriptorSets(Device& device) : device_(device) {}
  ~DescriptorSets();
  DescriptorSets(const DescriptorSets&) = delete;
  DescriptorSets& operator=(const DescriptorSets&) = delete;

  // A set of `layout`, which binds at most kMaxBindings storage or texel buffers, until the next take_back(). Throws DeviceError.
  VkDescriptorSet next(VkDescriptorSetLayout layout);
  // All sets may be handed out again: the GPU must be done with them. Throws DeviceError.
  void take_back();

  std::size_t pool_count() const { return pools_.size(); }

 private:
  Device& device_;
  std::vector<VkDescriptorPool> pools_;
  std::size_t taken_ = 0;  // sets, from the pools in order
};

}  // namespace hermite::gpu
