// Properties of a GPU that are known before it is used. Plain values.
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
  std::string driver;              // name and version
  std::uint32_t api_version = 0;   // as VK_MAKE_API_VERSION
  std::uint64_t memory_bytes = 0;  // largest device-local heap
  // Sum of all device-local heaps; meaningless for kCpu, whose memory is the host's.
  std::uint64_t all_memory_bytes = 0;
  // Largest storage buffer that can be allocated and bound as a whole.
  std::uint64_t max_buffer_bytes = 0;
  std::uint32_t max_shared_memory_bytes = 0;
  // Features that have a substitute where they are missing.
  bool has_push_descriptors = false;  // otherwise descriptor sets are allocated for each dispatch
  // Whether there are texel buffers of at least 4194304 texels; otherwise buffers that shaders only
  // read are storage buffers too.
  bool has_texel_buffers = false;
  bool has_64_bit_atomics = false;  // on buffers; otherwise passes need two steps
  std::string unsuitable;           // why it cannot be used, as text; empty when it can
};

// Returns the missing features that are substituted, as in "push descriptors, 64-bit atomics";
// empty if none is missing.
std::string substituted_as_text(const DeviceInfo& info);

// Returns one line such as "0: llvmpipe (cpu, Mesa 22.3.6)", with the reason if it is unsuitable.
std::string as_text(const DeviceInfo& info);

// Returns the position in `devices` that `select` means: empty for the best suitable one (discrete,
// integrated, virtual, cpu, other; then the first), an index, or a part of the name in any case
// (the best of those that match). Throws SetupError(kDevice) with a message that lists the
// available devices.
std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& select);

}  // namespace hermite::gpu
