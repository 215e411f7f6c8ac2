// A file descriptor that is closed by its destructor; negative: none. One thread at a time.
#pragma once

#include <unistd.h>

namespace hermite {

struct OwnedDescriptor {
  const int descriptor;
  explicit OwnedDescriptor(int opened) : descriptor(opened) {}
  ~OwnedDescriptor() {
    if (descriptor >= 0) close(descriptor);
  }
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
};

}  // namespace hermite
