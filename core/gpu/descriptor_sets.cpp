#include "core/gpu/descriptor_sets.h"

namespace hermite::gpu {

namespace {

constexpr std::uint32_t kSetsPerPool = 64;  // enough for a frame's longest list of commands

// The pool has room for all bindings of its sets, so the sets run out first.
VkDescriptorPool make_pool(const Device& device) {
  const VkDescriptorPoolSize sizes[] = {
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kSetsPerPool * kMaxBindings},
      {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, kSetsPerPool * kMaxBindings}};
  VkDescriptorPoolCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  create.maxSets = kSetsPerPool;
  create.poolSizeCount = 2;
  create.pPoolSizes = sizes;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  throw_if_failed(vkCreateDescriptorPool(device.vk(), &create, nullptr, &pool),
                  "make a descriptor pool");
  return pool;
}

}  // namespace

DescriptorSets::~DescriptorSets() {
  if (!device_.may_release()) return;
  for (VkDescriptorPool pool : pools_) vkDestroyDescriptorPool(device_.vk(), pool, nullptr);
}

VkDescriptorSet DescriptorSets::next(VkDescriptorSetLayout layout) {
  const std::size_t pool = taken_ / kSetsPerPool;
  if (pool == pools_.size()) pools_.push_back(make_pool(device_));
  VkDescriptorSetAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  allocate.descriptorPool = pools_[pool];
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  throw_if_failed(vkAllocateDescriptorSets(device_.vk(), &allocate, &set), "take a descriptor set");
  ++taken_;
  return set;
}

void DescriptorSets::take_back() {
  if (taken_ == 0) return;
  const std::size_t used = (taken_ - 1) / kSetsPerPool + 1;
  taken_ = 0;
  for (std::size_t i = 0; i < used; ++i)
    throw_if_failed(vkResetDescriptorPool(device_.vk(), pools_[i], 0), "reset a descriptor pool");
}

}  // namespace hermite::gpu
