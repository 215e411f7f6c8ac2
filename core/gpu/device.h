// A GPU opened for compute. Owns instance, device and queue; buffers, kernels and commands are made
// from it and must be destroyed before it.
//
// Everything is synchronous: whenever a call of core/gpu returns, the GPU is idle. A device and all
// objects made from it belong to one thread at a time. A lost or hung device throws DeviceError
// from then on; a new Device can be made.
#pragma once

#include <vulkan/vulkan.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/timeline.h"
#include "core/gpu/device_info.h"
#include "core/gpu/error.h"
#include "core/gpu/instance.h"

namespace hermite::gpu {

// Longer than any pass on the slowest machine, shorter than a person would wait.
inline constexpr std::chrono::milliseconds kWaitLimit = std::chrono::seconds(120);

// Returns the devices. Throws SetupError(kDevice) when there is no Vulkan loader or driver.
std::vector<DeviceInfo> list_devices();

class Transfer;

class Device {
 public:
  // `select` as in choose_device. Throws SetupError(kDevice) with a message that lists the
  // available devices.
  //
  // The validation layer is active if it is installed and the program was built with
  // HERMITE_VALIDATION=1; the environment variable HERMITE_VALIDATION=0 or 1 overrides that. A
  // `timeline`, which must outlive this object, gets every command that runs.
  //
  // The environment variable HERMITE_GPU_WITHOUT names features not to use although the device has
  // them, so that their substitutes can be tested: push-descriptors, texel-buffers, 64-bit-atomics,
  // separated by commas.
  explicit Device(const std::string& select = "", Timeline* timeline = nullptr);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }

  // Returns the bytes of existing buffers by their purpose.
  std::map<std::string, std::int64_t> memory_by_purpose() const { return memory_by_purpose_; }

  struct PassTime {
    std::string kernel;   // "frame/bilateral"; "(fill)" and "(copy)" for those commands
    double total_ms = 0;  // GPU time stamps; 0 if the device has none
    std::int64_t dispatch_count = 0;
  };
  // Returns times summed since construction or the last reset, in the order in which the passes
  // first ran.
  std::vector<PassTime> pass_times() const;
  void reset_pass_times();

  bool validation_active() const { return instance_->validation_active(); }
  std::int64_t validation_error_count() const { return instance_->validation_error_count(); }

  // --- For the rest of core/gpu ---
  VkDevice vk() const { return handle_.device; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return queue_family_; }
  VkPipelineCache pipeline_cache() const { return pipeline_cache_; }
  // Nullptr where info() has none.
  PFN_vkCmdPushDescriptorSetKHR push_descriptors() const { return push_descriptors_; }
  const VkPhysicalDeviceLimits& limits() const { return limits_; }
  const VkPhysicalDeviceMemoryProperties& memory() const { return memory_; }
  std::uint32_t max_bindings() const { return max_bindings_; }  // most buffers of one kernel
  // Returns 0 if the queue has no time stamps.
  double timestamp_period_ns() const { return timestamp_period_ns_; }
  std::uint64_t timestamp_mask() const { return timestamp_mask_; }
  Transfer& transfer();  // made at first use

  void note_memory(const std::string& purpose, std::int64_t change_bytes);
  std::uint32_t pass_slot(std::string_view kernel);
  void add_pass_time(std::uint32_t slot, double ms);
  const std::string& pass_name(std::uint32_t slot) const { return pass_times_.at(slot).kernel; }
  Timeline* timeline() const { return timeline_; }

  void throw_if_lost() const;
  // Submits, does `meanwhile` on this thread unless it is empty, and waits until the GPU is done;
  // throws DeviceError otherwise. Afterwards `fence` is unsignalled and can be used again. What
  // `meanwhile` throws is thrown then.
  void submit_and_wait(VkCommandBuffer commands, VkFence fence, std::chrono::milliseconds limit,
                       const std::function<void()>& meanwhile);
  // Returns false while the GPU may still use objects of a timed-out submission; then memory must
  // be leaked rather than freed.
  bool may_release() noexcept;

 private:
  struct Handle {  // first to be made and last to be destroyed, also when the constructor throws
    VkDevice device = VK_NULL_HANDLE;
    ~Handle() { vkDestroyDevice(device, nullptr); }
  };
  void open(VkPhysicalDevice physical);
  void read_properties(VkPhysicalDevice physical);
  void throw_as_lost(VkResult result);

  std::unique_ptr<Instance> instance_;
  Handle handle_;
  DeviceInfo info_;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0;
  VkPipelineCache pipeline_cache_ = VK_NULL_HANDLE;
  PFN_vkCmdPushDescriptorSetKHR push_descriptors_ = nullptr;
  VkPhysicalDeviceLimits limits_{};
  VkPhysicalDeviceMemoryProperties memory_{};
  std::uint32_t max_bindings_ = 0;
  double timestamp_period_ns_ = 0;
  std::uint64_t timestamp_mask_ = 0;
  std::unique_ptr<Transfer> transfer_;
  std::map<std::string, std::int64_t> memory_by_purpose_;
  std::vector<PassTime> pass_times_;
  Timeline* const timeline_;
  std::string lost_;                  // why the device can no longer be used, as text
  VkFence hung_on_ = VK_NULL_HANDLE;  // fence of the timed-out submission
  // The fence was never signalled: everything that the submission may use is leaked, including the
  // device.
  bool given_up_ = false;
};

}  // namespace hermite::gpu
