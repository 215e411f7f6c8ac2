#include "core/gpu/device.h"

#include <fmt/core.h>

#include <algorithm>
#include <exception>

#include "core/gpu/descriptor_sets.h"
#include "core/gpu/transfer.h"

namespace hermite::gpu {

namespace {

// Features beyond the core that the shaders may use. They are enabled where present, so that a
// shader that needs a missing one fails when it is compiled, with a message.
struct Features {
  VkPhysicalDeviceVulkan11Features vulkan11{};
  VkPhysicalDeviceVulkan12Features vulkan12{};
  VkPhysicalDeviceFeatures2 core{};

  Features(VkPhysicalDevice physical, const DeviceInfo& info) {
    vulkan11.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES;
    vulkan11.pNext = &vulkan12;
    vulkan12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    core.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    core.pNext = &vulkan11;
    vkGetPhysicalDeviceFeatures2(physical, &core);
    keep_what_we_use(info);
  }

 private:
  void keep_what_we_use(const DeviceInfo& info) {
    const VkPhysicalDeviceFeatures has = core.features;
    core.features = {};
    // A shader must never access memory outside its buffers, whatever a sensor sends: other scans
    // run in the same process.
    core.features.robustBufferAccess = VK_TRUE;
    core.features.shaderInt16 = has.shaderInt16;
    core.features.shaderInt64 = info.has_64_bit_atomics;
    core.features.shaderFloat64 = has.shaderFloat64;

    const VkPhysicalDeviceVulkan11Features has11 = vulkan11;
    vulkan11 = {};
    vulkan11.sType = has11.sType;
    vulkan11.pNext = has11.pNext;
    vulkan11.storageBuffer16BitAccess = has11.storageBuffer16BitAccess;

    const VkPhysicalDeviceVulkan12Features has12 = vulkan12;
    vulkan12 = {};
    vulkan12.sType = has12.sType;
    vulkan12.scalarBlockLayout = VK_TRUE;
    vulkan12.storageBuffer8BitAccess = has12.storageBuffer8BitAccess;
    vulkan12.shaderInt8 = has12.shaderInt8;
    vulkan12.shaderFloat16 = has12.shaderFloat16;
    vulkan12.shaderBufferInt64Atomics = info.has_64_bit_atomics;
  }
};

std::exception_ptr thrown_by(const std::function<void()>& work) {
  if (!work) return nullptr;
  try {
    work();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

}  // namespace

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (const Instance::Candidate& candidate : Instance().candidates())
    infos.push_back(candidate.info);
  return infos;
}

Device::Device(const std::string& select, Timeline* timeline)
    : instance_(std::make_unique<Instance>()), timeline_(timeline) {
  const std::vector<Instance::Candidate> candidates = instance_->candidates();
  std::vector<DeviceInfo> infos;
  for (const Instance::Candidate& candidate : candidates) infos.push_back(candidate.info);
  const std::size_t chosen = choose_device(infos, select);
  info_ = infos[chosen];
  open(candidates[chosen].handle);
}

void Device::open(VkPhysicalDevice physical) {
  queue_family_ = static_cast<std::uint32_t>(find_compute_family(physical));
  const Features features(physical, info_);
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  const char* const extension = VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME;
  VkDeviceCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  create.pNext = &features.core;
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  create.enabledExtensionCount = info_.has_push_descriptors ? 1 : 0;
  create.ppEnabledExtensionNames = &extension;
  throw_if_failed(vkCreateDevice(physical, &create, nullptr, &handle_.device),
                  ("open the GPU " + info_.name).c_str());

  vkGetDeviceQueue(vk(), queue_family_, 0, &queue_);
  if (info_.has_push_descriptors) {
    push_descriptors_ = reinterpret_cast<PFN_vkCmdPushDescriptorSetKHR>(
        vkGetDeviceProcAddr(vk(), "vkCmdPushDescriptorSetKHR"));
    if (!push_descriptors_)
      throw DeviceError(fmt::format(
          "cannot open the GPU {}: its driver lacks vkCmdPushDescriptorSetKHR", info_.name));
  }
  read_properties(physical);
  VkPipelineCacheCreateInfo cache{};
  cache.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
  throw_if_failed(vkCreatePipelineCache(vk(), &cache, nullptr, &pipeline_cache_),
                  "make a pipeline cache");
}

void Device::read_properties(VkPhysicalDevice physical) {
  VkPhysicalDevicePushDescriptorPropertiesKHR push{};
  push.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PUSH_DESCRIPTOR_PROPERTIES_KHR;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  if (info_.has_push_descriptors) properties.pNext = &push;
  vkGetPhysicalDeviceProperties2(physical, &properties);
  limits_ = properties.properties.limits;
  max_bindings_ =
      info_.has_push_descriptors ? std::min(push.maxPushDescriptors, kMaxBindings) : kMaxBindings;
  vkGetPhysicalDeviceMemoryProperties(physical, &memory_);

  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  const std::uint32_t bits = families.at(queue_family_).timestampValidBits;
  timestamp_mask_ = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  timestamp_period_ns_ = bits == 0 ? 0 : static_cast<double>(limits_.timestampPeriod);
}

Device::~Device() {
  transfer_.reset();
  if (!may_release()) {
    // Destroying a device that is still working is undefined behaviour, so it is leaked together
    // with its instance.
    handle_.device = VK_NULL_HANDLE;
    static_cast<void>(instance_.release());
    return;
  }
  vkDestroyPipelineCache(vk(), pipeline_cache_, nullptr);
}

Transfer& Device::transfer() {
  if (!transfer_) transfer_ = std::make_unique<Transfer>(*this);
  return *transfer_;
}

std::vector<Device::PassTime> Device::pass_times() const {
  std::vector<PassTime> ran;
  std::copy_if(pass_times_.begin(), pass_times_.end(), std::back_inserter(ran),
               [](const PassTime& pass) { return pass.dispatch_count > 0; });
  return ran;
}

void Device::reset_pass_times() {
  for (PassTime& pass : pass_times_)
    pass = {pass.kernel, 0, 0};  // kernels keep the indices of their slots
}

void Device::note_memory(const std::string& purpose, std::int64_t change_bytes) {
  std::int64_t& bytes = memory_by_purpose_[purpose];
  bytes += change_bytes;
  if (bytes == 0) memory_by_purpose_.erase(purpose);
}

std::uint32_t Device::pass_slot(std::string_view kernel) {
  const auto known = std::find_if(pass_times_.begin(), pass_times_.end(),
                                  [kernel](const PassTime& pass) { return pass.kernel == kernel; });
  if (known == pass_times_.end()) {
    pass_times_.push_back({std::string(kernel), 0, 0});
    return static_cast<std::uint32_t>(pass_times_.size() - 1);
  }
  return static_cast<std::uint32_t>(known - pass_times_.begin());
}

void Device::add_pass_time(std::uint32_t slot, double ms) {
  pass_times_.at(slot).total_ms += ms;
  ++pass_times_.at(slot).dispatch_count;
}

void Device::throw_if_lost() const {
  if (!lost_.empty())
    throw DeviceError(fmt::format("the GPU {} cannot be used any more: {}", info_.name, lost_));
}

void Device::submit_and_wait(VkCommandBuffer commands, VkFence fence,
                             std::chrono::milliseconds limit,
                             const std::function<void()>& meanwhile) {
  throw_if_lost();
  VkSubmitInfo submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  const VkResult submitted = vkQueueSubmit(queue_, 1, &submit, fence);
  if (submitted != VK_SUCCESS) throw_as_lost(submitted);
  const std::exception_ptr thrown = thrown_by(meanwhile);
  const auto limit_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(limit).count();
  VkResult result = vkWaitForFences(vk(), 1, &fence, VK_TRUE, static_cast<std::uint64_t>(limit_ns));
  if (result == VK_TIMEOUT) {
    hung_on_ = fence;
    lost_ = fmt::format("it hung, no answer within {} ms", limit.count());
    throw_if_lost();
  }
  if (result == VK_SUCCESS) result = vkResetFences(vk(), 1, &fence);
  if (result != VK_SUCCESS) throw_as_lost(result);
  if (thrown) std::rethrow_exception(thrown);
}

// Throws for the failure of a submission.
void Device::throw_as_lost(VkResult result) {
  if (result == VK_ERROR_DEVICE_LOST) {
    lost_ = as_text(result);
    throw_if_lost();
  }
  throw_if_failed(result, ("run commands on the GPU " + info_.name).c_str());
}

bool Device::may_release() noexcept {
  if (hung_on_ == VK_NULL_HANDLE) return true;
  constexpr std::uint64_t kLastChance_ns = 5'000'000'000;  // often it was only slow
  if (given_up_ || vkWaitForFences(vk(), 1, &hung_on_, VK_TRUE, kLastChance_ns) == VK_TIMEOUT) {
    given_up_ = true;
    return false;
  }
  hung_on_ = VK_NULL_HANDLE;
  return true;
}

}  // namespace hermite::gpu
