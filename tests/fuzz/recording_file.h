// Readers take paths: a file in memory that has one. Header only, Linux.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>
#include <string>

#include "core/dataset/recording.h"
#include "core/image/image_codec.h"

namespace hermite::fuzz {

class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size)
      : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
    if (descriptor_ < 0 || write(descriptor_, data, size) != static_cast<ssize_t>(size))
      throw std::runtime_error("no file in memory");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  const int descriptor_;
};

// What opens must keep its promises; errors must have words.
inline void check_recording(const Result<dataset::Recording>& recording) {
  if (!recording.ok()) {
    CHECK(!recording.error().message.empty(), "an error without words");
    return;
  }
  const dataset::Sequence& sequence = *recording->sequence;
  CHECK(validate(sequence.camera()).ok(), "a camera that is none");
  constexpr std::int64_t kEnough = 4;  // frames, so that one input takes little time
  for (std::int64_t i = 0; i < sequence.frame_count() && i < kEnough; ++i) {
    CHECK(i == 0 || sequence.timestamp_s(i) > sequence.timestamp_s(i - 1),
          "times that do not ascend");
    const auto frame = sequence.read(i);
    if (frame.ok())
      CHECK(frame->depth.width == sequence.camera().width, "an image of another size");
    if (frame.ok()) static_cast<void>(dataset::decode_frame(*frame));
  }
}

}  // namespace hermite::fuzz
