#include "core/gpu/buffer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>

#include "core/gpu/transfer.h"

namespace hermite::gpu {

namespace {

constexpr VkMemoryPropertyFlags kOnGpu = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
// Coherent, so that flushing and invalidation are never needed; every device has such memory.
constexpr VkMemoryPropertyFlags kHost =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags kHostCached = kHost | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

// Returns the first allowed memory type with all properties of the earliest of the `wishes` that
// any type fulfils; -1 if none does.
int find_memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                     std::initializer_list<VkMemoryPropertyFlags> wishes) {
  for (VkMemoryPropertyFlags wish : wishes)
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
      if ((allowed >> i & 1u) != 0 && (memory.memoryTypes[i].propertyFlags & wish) == wish)
        return static_cast<int>(i);
  return -1;
}

int find_memory_type(const Device& device, std::uint32_t allowed, Memory memory) {
  if (memory == Memory::kReadback)
    return find_memory_type(device.memory(), allowed, {kHostCached, kHost});
  // Mapping the device memory of a discrete card (resizable BAR) would make downloads very slow,
  // because the host would read uncached memory over the bus.
  const DeviceKind kind = device.info().kind;
  if (kind == DeviceKind::kIntegrated || kind == DeviceKind::kCpu)
    return find_memory_type(device.memory(), allowed, {kOnGpu | kHostCached, kOnGpu, kHost});
  return find_memory_type(device.memory(), allowed, {kOnGpu, kHost});
}

}  // namespace

RawBuffer::RawBuffer(Device& device, std::size_t bytes, std::size_t element_bytes,
                     std::string purpose, Memory memory)
    : device_(&device),
      bytes_(bytes),
      allocated_bytes_((std::max<VkDeviceSize>(bytes, 1) + 3) / 4 * 4),
      purpose_(std::move(purpose)) {
  const std::string wanted = fmt::format("{} for '{}'", bytes_as_text(bytes), purpose_);
  if (bytes > device.info().max_buffer_bytes)
    throw DeviceError(fmt::format("the GPU {} has no buffers of {}, its limit is {}",
                                  device.info().name, wanted,
                                  bytes_as_text(device.info().max_buffer_bytes)));
  try {
    allocate(memory);
    make_texels(element_bytes);
    clear();
  } catch (const DeviceError& error) {
    release();
    std::int64_t used_bytes = 0;
    for (const auto& [other_purpose, live_bytes] : device.memory_by_purpose())
      used_bytes += live_bytes;
    throw DeviceError(fmt::format("no buffer of {} beside {} in use: {}", wanted,
                                  bytes_as_text(static_cast<std::uint64_t>(used_bytes)),
                                  error.what()));
  }
}

void RawBuffer::allocate(Memory memory) {
  VkBufferCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  create.size = allocated_bytes_;
  create.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                 VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  throw_if_failed(vkCreateBuffer(device_->vk(), &create, nullptr, &buffer_), "make a buffer");
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device_->vk(), buffer_, &needs);
  const int type = find_memory_type(*device_, needs.memoryTypeBits, memory);
  if (type < 0) throw DeviceError("no fitting kind of memory");

  VkMemoryAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = static_cast<std::uint32_t>(type);
  throw_if_failed(vkAllocateMemory(device_->vk(), &allocate, nullptr, &memory_), "allocate memory");
  device_->note_memory(purpose_, static_cast<std::int64_t>(allocated_bytes_));
  throw_if_failed(vkBindBufferMemory(device_->vk(), buffer_, memory_, 0), "bind memory");

  const VkMemoryPropertyFlags has = device_->memory().memoryTypes[type].propertyFlags;
  const bool discrete_memory = memory == Memory::kDevice && (has & kHostCached) != kHostCached;
  if ((has & kHost) == kHost && !discrete_memory)
    throw_if_failed(vkMapMemory(device_->vk(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_),
                    "map memory");
}

void RawBuffer::make_texels(std::size_t element_bytes) {
  const std::size_t texel_bytes = element_bytes % 16 == 0 ? 16 : element_bytes % 8 == 0 ? 8 : 4;
  if (!device_->info().has_texel_buffers) return;
  if (allocated_bytes_ < texel_bytes ||
      allocated_bytes_ / texel_bytes > device_->limits().maxTexelBufferElements)
    return;
  VkBufferViewCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
  create.buffer = buffer_;
  create.format = VK_FORMAT_R32_UINT;
  if (texel_bytes == 8) create.format = VK_FORMAT_R32G32_UINT;
  if (texel_bytes == 16) create.format = VK_FORMAT_R32G32B32A32_UINT;
  create.range = allocated_bytes_ / texel_bytes * texel_bytes;
  throw_if_failed(vkCreateBufferView(device_->vk(), &create, nullptr, &texels_),
                  "make a view of a buffer");
}

void RawBuffer::clear() {
  if (mapped_)
    std::memset(mapped_, 0, allocated_bytes_);
  else
    device_->transfer().fill_with_zero(buffer_);
}

RawBuffer::~RawBuffer() { release(); }

void RawBuffer::release() noexcept {
  if (!device_) return;
  if (memory_ != VK_NULL_HANDLE)
    device_->note_memory(purpose_, -static_cast<std::int64_t>(allocated_bytes_));
  if (device_->may_release()) {
    vkDestroyBufferView(device_->vk(), texels_, nullptr);
    vkDestroyBuffer(device_->vk(), buffer_, nullptr);
    vkFreeMemory(device_->vk(), memory_, nullptr);
  }
  device_ = nullptr;
  buffer_ = VK_NULL_HANDLE;
  memory_ = VK_NULL_HANDLE;
  texels_ = VK_NULL_HANDLE;
  mapped_ = nullptr;
  bytes_ = 0;
  allocated_bytes_ = 0;
}

RawBuffer::RawBuffer(RawBuffer&& other) noexcept { *this = std::move(other); }

RawBuffer& RawBuffer::operator=(RawBuffer&& other) noexcept {
  if (this == &other) return *this;
  release();
  device_ = std::exchange(other.device_, nullptr);
  buffer_ = std::exchange(other.buffer_, VK_NULL_HANDLE);
  memory_ = std::exchange(other.memory_, VK_NULL_HANDLE);
  texels_ = std::exchange(other.texels_, VK_NULL_HANDLE);
  mapped_ = std::exchange(other.mapped_, nullptr);
  bytes_ = std::exchange(other.bytes_, 0);
  allocated_bytes_ = std::exchange(other.allocated_bytes_, 0);
  purpose_ = std::move(other.purpose_);
  return *this;
}

void RawBuffer::upload(const void* source, std::size_t bytes, std::size_t first_byte) {
  CHECK(bytes <= bytes_ && first_byte <= bytes_ - bytes,
        fmt::format("upload outside the buffer '{}'", purpose_));
  if (bytes == 0) return;
  if (mapped_)
    std::memcpy(static_cast<std::byte*>(mapped_) + first_byte, source, bytes);
  else
    device_->transfer().upload(source, buffer_, first_byte, bytes);
}

void RawBuffer::download(void* target, std::size_t bytes, std::size_t first_byte) const {
  CHECK(bytes <= bytes_ && first_byte <= bytes_ - bytes,
        fmt::format("download outside the buffer '{}'", purpose_));
  if (bytes == 0) return;
  if (mapped_)
    std::memcpy(target, static_cast<const std::byte*>(mapped_) + first_byte, bytes);
  else
    device_->transfer().download(buffer_, first_byte, target, bytes);
}

}  // namespace hermite::gpu
