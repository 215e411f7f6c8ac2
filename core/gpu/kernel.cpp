#include "core/gpu/kernel.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "core/base/check.h"

namespace hermite::gpu {

namespace {

const EmbeddedKernel& find_embedded(ReadAs read_as, std::string_view name) {
  const std::span<const EmbeddedKernel> all = embedded_kernels(read_as);
  const auto found = std::find_if(
      all.begin(), all.end(), [name](const EmbeddedKernel& kernel) { return kernel.name == name; });
  CHECK(found != all.end(), fmt::format("there is no shader '{}'", name));
  return *found;
}

// A shader module is only needed while its pipeline is created.
struct Module {
  VkDevice device = VK_NULL_HANDLE;
  VkShaderModule handle = VK_NULL_HANDLE;
  ~Module() { vkDestroyShaderModule(device, handle, nullptr); }
};

std::uint32_t round_up_to_4(std::uint32_t bytes) { return (bytes + 3) / 4 * 4; }

}  // namespace

VkDescriptorType descriptor_type(Binding kind) {
  return kind == Binding::kTexels ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                                  : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

Kernel::Kernel(Device& device, std::string_view name,
               const std::vector<std::uint32_t>& specialization)
    : device_(&device),
      name_(name),
      shader_(&find_embedded(device.info().has_texel_buffers ? ReadAs::kTexels : ReadAs::kStorage,
                             name)),
      pass_slot_(device.pass_slot(name)) {
  specialise_local_size(specialization);
  check_limits();
  try {
    create_layout();
    create_pipeline(specialization);
  } catch (const DeviceError& error) {
    release();
    throw DeviceError(fmt::format("shader '{}': {}", name_, error.what()));
  }
}

void Kernel::specialise_local_size(const std::vector<std::uint32_t>& specialization) {
  local_size_ = shader_->interface.local_size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<std::uint32_t> constant = shader_->interface.local_size_constant[axis];
    if (constant && *constant < specialization.size())
      local_size_[axis] = specialization[*constant];
  }
}

void Kernel::check_limits() const {
  if (shader_->interface.needs_64_bit_atomics && !device_->info().has_64_bit_atomics)
    throw DeviceError(fmt::format("shader '{}': the device has no 64-bit atomics", name_));
  const VkPhysicalDeviceLimits& limits = device_->limits();
  std::uint64_t invocations = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t size = local_size_[axis];
    CHECK(size > 0, fmt::format("shader '{}': a local size of 0", name_));
    if (size > limits.maxComputeWorkGroupSize[axis]) invocations = UINT32_MAX;  // rejected below
    invocations *= size;
  }
  if (invocations > limits.maxComputeWorkGroupInvocations)
    throw DeviceError(
        fmt::format("shader '{}': the device's work groups are smaller than the shader's", name_));
  const auto texel_count = static_cast<std::uint32_t>(
      std::count(bindings().begin(), bindings().end(), Binding::kTexels));
  const auto buffer_count = static_cast<std::uint32_t>(bindings().size());
  if (buffer_count > device_->max_bindings() ||
      texel_count > limits.maxPerStageDescriptorSampledImages ||
      buffer_count - texel_count > limits.maxPerStageDescriptorStorageBuffers)
    throw DeviceError(fmt::format(
        "shader '{}': {} buffers, {} of them as texels; the device binds {}, {} of them as storage "
        "and {} as texels",
        name_, buffer_count, texel_count, device_->max_bindings(),
        limits.maxPerStageDescriptorStorageBuffers, limits.maxPerStageDescriptorSampledImages));
  if (push_constant_bytes() > limits.maxPushConstantsSize)
    throw DeviceError(fmt::format("shader '{}': {} bytes of push constants, the device takes {}",
                                  name_, push_constant_bytes(), limits.maxPushConstantsSize));
}

void Kernel::create_layout() {
  std::vector<VkDescriptorSetLayoutBinding> layout_bindings;
  for (const Binding kind : bindings())
    layout_bindings.push_back({static_cast<std::uint32_t>(layout_bindings.size()),
                               descriptor_type(kind), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  if (device_->info().has_push_descriptors)
    set.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  set.bindingCount = static_cast<std::uint32_t>(layout_bindings.size());
  set.pBindings = layout_bindings.data();
  throw_if_failed(vkCreateDescriptorSetLayout(device_->vk(), &set, nullptr, &set_layout_),
                  "make a descriptor set layout");

  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                  round_up_to_4(push_constant_bytes())};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout_;
  layout.pushConstantRangeCount = range.size > 0 ? 1 : 0;
  layout.pPushConstantRanges = &range;
  throw_if_failed(vkCreatePipelineLayout(device_->vk(), &layout, nullptr, &layout_),
                  "make a pipeline layout");
}

void Kernel::create_pipeline(const std::vector<std::uint32_t>& specialization) {
  VkShaderModuleCreateInfo code{};
  code.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  code.codeSize = shader_->words.size_bytes();
  code.pCode = shader_->words.data();
  Module shader{device_->vk()};
  throw_if_failed(vkCreateShaderModule(device_->vk(), &code, nullptr, &shader.handle), "load it");

  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < specialization.size(); ++i) entries.push_back({i, i * 4, 4});
  const VkSpecializationInfo constants{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                       specialization.size() * 4, specialization.data()};
  VkComputePipelineCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = shader.handle;
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = &constants;
  create.layout = layout_;
  throw_if_failed(vkCreateComputePipelines(device_->vk(), device_->pipeline_cache(), 1, &create,
                                           nullptr, &pipeline_),
                  "compile it");
}

Kernel::~Kernel() { release(); }

void Kernel::release() noexcept {
  if (!device_) return;
  if (device_->may_release()) {
    vkDestroyPipeline(device_->vk(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_->vk(), layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_->vk(), set_layout_, nullptr);
  }
  device_ = nullptr;
}

Kernel::Kernel(Kernel&& other) noexcept { *this = std::move(other); }

Kernel& Kernel::operator=(Kernel&& other) noexcept {
  if (this == &other) return *this;
  release();
  device_ = std::exchange(other.device_, nullptr);
  name_ = std::move(other.name_);
  shader_ = other.shader_;
  local_size_ = other.local_size_;
  pass_slot_ = other.pass_slot_;
  set_layout_ = std::exchange(other.set_layout_, VK_NULL_HANDLE);
  layout_ = std::exchange(other.layout_, VK_NULL_HANDLE);
  pipeline_ = std::exchange(other.pipeline_, VK_NULL_HANDLE);
  return *this;
}

}  // namespace hermite::gpu
