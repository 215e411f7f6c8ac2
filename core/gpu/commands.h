// A list of dispatches, fills and copies that run in order; each sees all writes of those before
// it.
//
//   commands.dispatch(gradient_, {width, height}, params,
//                     {{"intensity", intensity_}, {"image", image_}});
//   commands.submit_and_wait();
//
// Recording takes a few microseconds and does not allocate memory once lists have reached their
// usual length. Buffers and kernels must live until submit_and_wait() returns.
#pragma once

#include <vulkan/vulkan.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/gpu/buffer.h"
#include "core/gpu/command_buffer.h"
#include "core/gpu/descriptor_sets.h"
#include "core/gpu/kernel.h"

namespace hermite::gpu {

// Number of invocations. Only whole workgroups run, so shaders check their bounds. If any is zero,
// nothing runs.
struct Threads {
  std::uint32_t x = 1, y = 1, z = 1;
};

// Three words of a buffer that contain the number of workgroups along each axis.
struct GroupCounts {
  BufferRef buffer;
  std::uint32_t first_word = 0;
};

// A buffer with its name in the shader.
struct NamedBuffer {
  std::string_view name;
  BufferRef buffer;
};

class Commands {
 public:
  explicit Commands(Device& device);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  // `buffers` are in binding order. CHECK: they are as many as the shader binds, under its names,
  // and sizeof(Params) is the shader's push-constant size (rounded up to 4). Throws DeviceError
  // when the grid is too large for the device, when a buffer is too large for a texel buffer, or
  // when the device is lost.
  template <class Params>
  void dispatch(const Kernel& kernel, Threads threads, const Params& params,
                std::initializer_list<NamedBuffer> buffers) {
    static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) % 4 == 0);
    record(kernel, threads, {&params, sizeof(Params)}, buffers);
  }
  void dispatch(const Kernel& kernel, Threads threads, std::initializer_list<NamedBuffer> buffers) {
    record(kernel, threads, {}, buffers);
  }

  // Runs as many workgroups as `groups` contains once the commands before have run; at most 65535
  // along each axis.
  template <class Params>
  void dispatch_indirect(const Kernel& kernel, GroupCounts groups, const Params& params,
                         std::initializer_list<NamedBuffer> buffers) {
    static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) % 4 == 0);
    record_indirect(kernel, groups, {&params, sizeof(Params)}, buffers);
  }
  void dispatch_indirect(const Kernel& kernel, GroupCounts groups,
                         std::initializer_list<NamedBuffer> buffers) {
    record_indirect(kernel, groups, {}, buffers);
  }

  void fill(BufferRef buffer, std::uint32_t value);
  // Copies the first `bytes`. CHECK: both buffers are at least that large, and `bytes` is a
  // multiple of 4.
  void copy(BufferRef from, BufferRef to, VkDeviceSize bytes);

  // Blocks until the GPU is done and adds the times to Device::pass_times() and to the device's
  // timeline; then new commands can be recorded. Returns at once if nothing is recorded. Throws
  // DeviceError when the device is lost or does not answer within `limit`; the recorded commands
  // are dropped.
  void submit_and_wait(std::chrono::milliseconds limit = kWaitLimit) {
    submit_and_wait_beside(nullptr, limit);
  }

  // The same, and does `meanwhile` on this thread while the GPU is busy, also if nothing is
  // recorded. It must neither record commands nor access buffers. What it throws is thrown once the
  // GPU is done.
  void submit_and_wait_beside(const std::function<void()>& meanwhile,
                              std::chrono::milliseconds limit = kWaitLimit);

 private:
  struct Constants {
    const void* bytes = nullptr;
    std::size_t size = 0;
  };
  struct Stamped {
    std::uint32_t pass_slot = 0;
    std::uint64_t invocations = 0, bytes_within_reach = 0;  // as in Timeline::Pass
  };
  void record(const Kernel& kernel, Threads threads, Constants constants,
              std::initializer_list<NamedBuffer> buffers);
  void bind(const Kernel& kernel, Constants constants, std::initializer_list<NamedBuffer> buffers);
  void record_indirect(const Kernel& kernel, GroupCounts groups, Constants constants,
                       std::initializer_list<NamedBuffer> buffers);
  void bind_buffers(const Kernel& kernel, std::initializer_list<NamedBuffer> buffers);
  // Returns the command buffer after a barrier; the first call also writes the first time stamp.
  VkCommandBuffer next();
  void stamp(const Stamped& command);  // after each command
  void write_timestamp(std::uint32_t index);
  void read_ticks();
  void collect_times(Timeline::Clock::time_point submitted);

  Device& device_;
  CommandBuffer commands_;
  // Descriptor sets of the commands that are recorded or have just run; empty where descriptors are
  // pushed.
  DescriptorSets sets_;
  std::vector<VkQueryPool> query_pools_;  // grows to the longest list so far, within a limit
  std::vector<Stamped> stamped_;          // by stamp, without the first stamp
  // Result of read_ticks(): one more than stamped_; fewer if not all commands are timed.
  std::vector<std::uint64_t> ticks_;
  std::uint32_t fill_slot_ = 0, copy_slot_ = 0;
};

}  // namespace hermite::gpu
