#include "core/gpu/transfer.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/gpu/buffer.h"

namespace hermite::gpu {

namespace {
// Enough for a frame; larger pieces are not faster.
constexpr std::size_t kStagingBytes = std::size_t{8} * 1024 * 1024;
}  // namespace

Transfer::Transfer(Device& device) : device_(device), commands_(device) {}
Transfer::~Transfer() = default;

RawBuffer& Transfer::staging() {
  if (!staging_)
    staging_ = std::make_unique<RawBuffer>(device_, kStagingBytes, 4, "staging", Memory::kReadback);
  return *staging_;
}

void Transfer::upload(const void* source, VkBuffer target, VkDeviceSize first_byte,
                      std::size_t bytes) {
  const auto* from = static_cast<const std::uint8_t*>(source);
  for (std::size_t done = 0; done < bytes;) {
    const std::size_t piece = std::min(bytes - done, kStagingBytes);
    std::memcpy(staging().mapped(), from + done, piece);
    const VkBufferCopy region{0, first_byte + done, piece};
    vkCmdCopyBuffer(commands_.vk(), staging().ref().buffer, target, 1, &region);
    commands_.run();
    done += piece;
  }
}

void Transfer::download(VkBuffer source, VkDeviceSize first_byte, void* target, std::size_t bytes) {
  auto* to = static_cast<std::uint8_t*>(target);
  for (std::size_t done = 0; done < bytes;) {
    const std::size_t piece = std::min(bytes - done, kStagingBytes);
    commands_.barrier();
    const VkBufferCopy region{first_byte + done, 0, piece};
    vkCmdCopyBuffer(commands_.vk(), source, staging().ref().buffer, 1, &region);
    commands_.run();
    std::memcpy(to + done, staging().mapped(), piece);
    done += piece;
  }
}

void Transfer::fill_with_zero(VkBuffer target) {
  vkCmdFillBuffer(commands_.vk(), target, 0, VK_WHOLE_SIZE, 0);
  commands_.run();
}

}  // namespace hermite::gpu
