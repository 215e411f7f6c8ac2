// Arrays in GPU memory, initialised with zeros. A shader binds one as a storage buffer, or as a
// texel buffer if it only reads it and the device supports large texel buffers (embedded.h has
// both). A texel has the size of the array's elements, or of the widest of 4, 8 and 16 bytes that
// divides them.
//
// Host access is immediate: it does not wait for commands that are recorded but not yet submitted,
// and these will see the data that it wrote. A buffer must be destroyed before its device, and
// commands must not use it afterwards. Moving is cheap; a moved-from buffer is empty. Throws
// DeviceError when the device refuses; the message names purpose and size.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/gpu/device.h"

namespace hermite::gpu {

enum class Memory {
  // Fast for the GPU; the host copies through a staging buffer, or directly where both share the
  // memory (integrated, CPU).
  kDevice,
  // Always mapped and cached for the host; the GPU can read and write it, slowly on discrete
  // devices.
  kReadback,
};

// The buffer that a dispatch binds. `bytes` is rounded up to a multiple of 4, and at least 4.
struct BufferRef {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize bytes = 0;
  // None if the size is no multiple of a texel, or above the device's limit for texel buffers.
  VkBufferView texels = VK_NULL_HANDLE;
};

class RawBuffer {
 public:
  RawBuffer() = default;
  RawBuffer(Device& device, std::size_t bytes, std::size_t element_bytes, std::string purpose,
            Memory memory);
  ~RawBuffer();
  RawBuffer(RawBuffer&& other) noexcept;
  RawBuffer& operator=(RawBuffer&& other) noexcept;

  std::size_t bytes() const { return bytes_; }
  BufferRef ref() const { return {buffer_, allocated_bytes_, texels_}; }
  void* mapped() const { return mapped_; }  // nullptr where the host cannot access the memory

  // CHECK: the range is within bytes().
  void upload(const void* source, std::size_t bytes, std::size_t first_byte);
  void download(void* target, std::size_t bytes, std::size_t first_byte) const;

 private:
  void allocate(Memory memory);
  void make_texels(std::size_t element_bytes);
  void clear();
  void release() noexcept;

  Device* device_ = nullptr;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkBufferView texels_ = VK_NULL_HANDLE;
  void* mapped_ = nullptr;
  std::size_t bytes_ = 0;
  VkDeviceSize allocated_bytes_ = 0;
  std::string purpose_;
};

template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Buffer() = default;  // empty, cannot be bound
  Buffer(Device& device, std::size_t count, std::string purpose, Memory memory = Memory::kDevice)
      : raw_(device, bytes_of(count), sizeof(T), std::move(purpose), memory), count_(count) {}
  Buffer(Buffer&& other) noexcept
      : raw_(std::move(other.raw_)), count_(std::exchange(other.count_, 0)) {}
  Buffer& operator=(Buffer&& other) noexcept {
    raw_ = std::move(other.raw_);
    count_ = std::exchange(other.count_, 0);
    return *this;
  }

  std::size_t count() const { return count_; }
  std::size_t bytes() const { return raw_.bytes(); }

  // Copy elements from `first` on. CHECK: the range is within count().
  void upload(std::span<const T> values, std::size_t first = 0) {
    raw_.upload(values.data(), values.size_bytes(), first * sizeof(T));
  }
  void download_into(std::span<T> values, std::size_t first = 0) const {
    raw_.download(values.data(), values.size_bytes(), first * sizeof(T));
  }
  std::vector<T> download() const { return download(count_); }
  std::vector<T> download(std::size_t count_wanted, std::size_t first = 0) const {
    CHECK(count_wanted <= count_ && first <= count_ - count_wanted, "download outside the buffer");
    std::vector<T> values(count_wanted);
    download_into(values, first);
    return values;
  }

  // Direct view, without a copy. CHECK: is_mapped(), which is always true for kReadback.
  bool is_mapped() const { return raw_.mapped() != nullptr; }
  std::span<const T> mapped() const {
    CHECK(is_mapped(), "mapped() of memory that the host cannot see");
    return {static_cast<const T*>(raw_.mapped()), count_};
  }

  operator BufferRef() const { return raw_.ref(); }

 private:
  // A count too large for the multiplication must not wrap around to a small size.
  static std::size_t bytes_of(std::size_t count) {
    return count > SIZE_MAX / sizeof(T) ? SIZE_MAX : count * sizeof(T);
  }

  RawBuffer raw_;
  std::size_t count_ = 0;
};

}  // namespace hermite::gpu
