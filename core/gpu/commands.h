// A list of dispatches, fills and copies, run in order: each sees all that those before it wrote.
//
//   commands.dispatch(gradient_, {width, height}, params, {{"intensity", intensity_}, {"picture", picture_}});
//   commands.submit_and_wait();
//
// Recording costs a few microseconds and no allocation once warm. Buffers and kernels must live until submit_and_wait() returns.
#pragma once

#include <vulkan/vulkan.h>

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/gpu/buffer.h"
#include "core/gpu/command_buffer.h"
#include "core/gpu/descriptor_sets.h"
#include "core/gpu/kernel.h"

namespace hermite::gpu {

// Invocations wanted. Whole work groups run, so shaders check their bounds. Zero anywhere: nothing runs.
struct Threads {
  std::uint32_t x = 1, y = 1, z = 1;
};

// Three words of a buffer that say how many work groups to run along each axis.
struct GroupCounts {
  BufferRef buffer;
  std::uint32_t first_word = 0;
};

// A buffer under the name that the shader has for it.
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

  // `buffers` in binding order. CHECK: as many as the shader binds, under its names, and sizeof(Params) is the shader's push-constant size
  // (rounded up to 4). Throws DeviceError when the device has no grid this large or no texel buffer as large as one that is read so, or is
  // lost.
  template <class Params>
  void dispatch(const Kernel& kernel, Threads threads, const Params& params, std::initializer_list<NamedBuffer> buffers) {
    static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) % 4 == 0);
    record(kernel, threads, {&params, sizeof(Params)}, buffers);
  }
  void dispatch(const Kernel& kernel, Threads threads, std::initializer_list<NamedBuffer> buffers) { record(kernel, threads, {}, buffers); }

  // As many work groups as `groups` says once the commands before have run: at most 65535 along each axis.
  template <class Params>
  void dispatch_indirect(const Kernel& kernel, GroupCounts groups, const Params& params, std::initializer_list<NamedBuffer> buffers) {
    static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) % 4 == 0);
    record_indirect(kernel, groups, {&params, sizeof(Params)}, buffers);
  }
  void dispatch_indirect(const Kernel& kernel, GroupCounts groups, std::initializer_list<NamedBuffer> buffers) {
    record_indirect(kernel, groups, {}, buffers);
  }

  void fill(BufferRef buffer, std::uint32_t value);
  // The first `bytes` of each. CHECK: both are that large, `bytes` is a multiple of 4.
  void copy(BufferRef from, BufferRef to, VkDeviceSize bytes);

  // Blocks until the GPU is done, adds the times to Device::pass_times() and the device's timeline, and is ready for more. Nothing
  // recorded: returns at once. Throws DeviceError when the device is lost or does not answer within `limit`; what was recorded is dropped.
  void submit_and_wait(std::chrono::milliseconds limit = kWaitLimit);

 private:
  struct Constants {
    const void* bytes = nullptr;
    std::size_t size = 0;
  };
  struct Stamped {
    std::uint32_t pass_slot = 0;
    std::uint64_t invocations = 0, bytes_within_reach = 0;  // as in Timeline::Pass
  };
  void record(const Kernel& kernel, Threads threads, Constants constants, std::initializer_list<NamedBuffer> buffers);
  void bind(const Kernel& kernel, Constants constants, std::initializer_list<NamedBuffer> buffers);
  void record_indirect(const Kernel& kernel, GroupCounts groups, Constants constants, std::initializer_list<NamedBuffer> buffers);
  void bind_buffers(const Kernel& kernel, std::initializer_list<NamedBuffer> buffers);
  VkCommandBuffer next();              // after a barrier; the first also writes the first time stamp
  void stamp(const Stamped& command);  // after each command
  void write_timestamp(std::uint32_t index);
  void read_ticks();
  void collect_times(Timeline::Clock::time_point submitted);

  Device& device_;
  CommandBuffer commands_;
  DescriptorSets sets_;                   // of what is recorded or has just run; none where descriptors are pushed
  std::vector<VkQueryPool> query_pools_;  // grows to the longest list seen, within a bound
  std::vector<Stamped> stamped_;          // before each stamp but the first
  std::vector<std::uint64_t> ticks_;      // read_ticks(): one more than stamped_, fewer where not all are timed
  std::uint32_t fill_slot_ = 0, copy_slot_ = 0;
};

}  // namespace hermite::gpu
