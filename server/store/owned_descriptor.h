// A file descriptor that is closed by its destructor; negative: none. One thread at a time.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace hermite::server {

struct OwnedDescriptor {
  const int descriptor;
  explicit OwnedDescriptor(int opened) : descriptor(opened) {}
  ~OwnedDescriptor() {
    if (descriptor >= 0) close(descriptor);
  }
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
};

// Returns at most the first `max_bytes` of a file, without line ends at their end; empty when it
// cannot be read.
inline std::string read_line(const OwnedDescriptor& file, std::size_t max_bytes) {
  std::string text(max_bytes, '\0');
  const ssize_t count = pread(file.descriptor, text.data(), max_bytes, 0);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace hermite::server
