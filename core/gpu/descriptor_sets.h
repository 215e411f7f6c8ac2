// Descriptor sets for devices without push descriptors: allocated for one list of commands, and all
// taken back together. For core/gpu only.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gpu/device.h"

namespace hermite::gpu {

inline constexpr std::uint32_t kMaxBindings = 32;  // of a kernel

// Owns the pools, whose number grows with the longest list so far; must be destroyed before its
// device. One thread at a time.
class DescriptorSets {
 public:
  explicit DescriptorSets(Device& device) : device_(device) {}
  ~DescriptorSets();
  DescriptorSets(const DescriptorSets&) = delete;
  DescriptorSets& operator=(const DescriptorSets&) = delete;

  // Returns a set of `layout`, which binds at most kMaxBindings storage or texel buffers; valid
  // until the next take_back(). Throws DeviceError.
  VkDescriptorSet next(VkDescriptorSetLayout layout);
  // Makes all sets available again; the GPU must be done with them. Throws DeviceError.
  void take_back();

  std::size_t pool_count() const { return pools_.size(); }

 private:
  Device& device_;
  std::vector<VkDescriptorPool> pools_;
  std::size_t taken_ = 0;  // number of sets in use, from the pools in order
};

}  // namespace hermite::gpu
