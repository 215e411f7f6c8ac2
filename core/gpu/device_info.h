// What is known of a GPU before it is used. Plain values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hermite::gpu {

enum class DeviceKind { kDiscrete, kIntegrated, kVirtual, kCpu, kOther };
const char* name_of(DeviceKind kind);  // "discrete", "integrated", "virtual", "cpu", "other"

struct DeviceInfo {
  int index = 0;  // in the order of list_devices()
  std::string name;
  DeviceKind kind = DeviceKind::kOther;
  std::string driver;                  // name and version
  std::uint32_t api_version = 0;       // as VK_MAKE_API_VERSION
  std::uint64_t memory_bytes = 0;      // largest device-local heap
  std::uint64_t all_memory_bytes = 0;  // all device-local heaps together; for kCpu a number that says nothing: the memory is the host's
  std::uint64_t max_buffer_bytes = 0;  // largest storage buffer that can be allocated and bound whole
  std::uint32_t max_shared_memory_bytes = 0;
  // What has a substitute where it is missing.
  bool has_push_descriptors = false;  // else sets of descriptors are made for each dispatch
  bool has_texel_buffers = false;     // of 4194304 texels at least; else what shaders only read are storage buffers, too
  bool has_64_bit_atomics = false;    // on buffers; else passes need two steps
  std::string unsuitable;             // why it cannot be used, in words; empty when it can
};

// "push descriptors, 64-bit atomics": what is done without, by its substitute; empty when nothing is.
std::string substituted_in_words(const DeviceInfo& info);

// One line: "0: llvmpipe (cpu, Mesa 22.3.6)", and why not if so.
std::string in_words(const DeviceInfo& info);

// Position in `devices` of the one meant by `select`: empty for the best suitable one (discrete, integrated, virtual, cpu, other; then the
// first), an index, or a part of the name in any case (the best of those that match). Throws SetupError(kDevice) listing what there is.
std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& select);

}  // namespace hermite::gpu
