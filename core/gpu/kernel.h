// A shader ready to run; local size, bindings and push-constant size are read from its SPIR-V.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/gpu/device.h"
#include "core/gpu/spirv.h"

namespace hermite::gpu {

VkDescriptorType descriptor_type(Binding kind);  // for pipeline layouts and for writing descriptors

// Owns a compute pipeline. Movable; must be destroyed before its device. Immutable, so any number
// of Commands may dispatch it.
class Kernel {
 public:
  // `name` as in embedded.h ("frame/bilateral"); element i of `specialization` replaces constant_id
  // i. Throws DeviceError when the driver refuses the shader. CHECK: the name exists and
  // read_interface supports the shader.
  Kernel(Device& device, std::string_view name, std::vector<std::uint32_t> specialization = {});
  // The same for SPIR-V that is not embedded; `name` is for messages and times.
  Kernel(Device& device, std::string_view name, std::span<const std::uint32_t> words,
         const std::vector<std::uint32_t>& specialization);
  ~Kernel();
  Kernel(Kernel&& other) noexcept;
  Kernel& operator=(Kernel&& other) noexcept;

  const std::string& name() const { return name_; }
  // Where the device has no large texel buffers, embedded shaders bind only storage buffers.
  const std::vector<Binding>& bindings() const { return interface_.bindings; }
  // Those of the version with texel buffers.
  const std::vector<std::string>& binding_names() const { return interface_.binding_names; }
  std::uint32_t push_constant_bytes() const { return interface_.push_constant_bytes; }
  // Returns the local size after specialisation.
  const std::array<std::uint32_t, 3>& local_size() const { return interface_.local_size; }

  // --- For Commands ---
  VkPipeline pipeline() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }
  std::uint32_t pass_slot() const { return pass_slot_; }

 private:
  void read(std::span<const std::uint32_t> words, const std::vector<std::uint32_t>& specialization);
  void create_layout();
  void create_pipeline(std::span<const std::uint32_t> words,
                       const std::vector<std::uint32_t>& specialization);
  void release() noexcept;

  Device* device_ = nullptr;
  std::string name_;
  ShaderInterface interface_;
  std::uint32_t pass_slot_ = 0;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace hermite::gpu
