// A shader ready to run.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/gpu/device.h"
#include "core/gpu/embedded.h"

namespace hermite::gpu {

VkDescriptorType descriptor_type(Binding kind);  // for pipeline layouts and for writing descriptors

// Owns a compute pipeline. Movable; must be destroyed before its device. Immutable, so any number
// of Commands may dispatch it.
class Kernel {
 public:
  // `name` as in embedded.h ("frame/bilateral"); element i of `specialization` replaces constant_id
  // i. Throws DeviceError when the driver refuses the shader. CHECK: the name exists.
  Kernel(Device& device, std::string_view name,
         const std::vector<std::uint32_t>& specialization = {});
  ~Kernel();
  Kernel(Kernel&& other) noexcept;
  Kernel& operator=(Kernel&& other) noexcept;

  const std::string& name() const { return name_; }
  // Where the device has no large texel buffers, embedded shaders bind only storage buffers.
  const std::vector<Binding>& bindings() const { return shader_->interface.bindings; }
  const std::vector<std::string>& binding_names() const { return shader_->interface.binding_names; }
  std::uint32_t push_constant_bytes() const { return shader_->interface.push_constant_bytes; }
  // Returns the local size after specialisation.
  const std::array<std::uint32_t, 3>& local_size() const { return local_size_; }

  // --- For Commands ---
  VkPipeline pipeline() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }
  std::uint32_t pass_slot() const { return pass_slot_; }

 private:
  void specialise_local_size(const std::vector<std::uint32_t>& specialization);
  void check_limits() const;
  void create_layout();
  void create_pipeline(const std::vector<std::uint32_t>& specialization);
  void release() noexcept;

  Device* device_ = nullptr;
  std::string name_;
  const EmbeddedKernel* shader_ = nullptr;
  std::array<std::uint32_t, 3> local_size_ = {1, 1, 1};
  std::uint32_t pass_slot_ = 0;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace hermite::gpu
